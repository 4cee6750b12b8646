import { ask } from "./server";

/** Server-sent events by fetch, since the browser's own reader cannot send the API key. */

export interface ServerEvent {
  type: string;
  id: string;
  data: Record<string, unknown>;
}

/** Cuts a stream of text into events; what is not yet complete waits for the next piece. */
export class EventParser {
  private rest = "";

  push(text: string): ServerEvent[] {
    const blocks = (this.rest + text).split(/\r?\n\r?\n/);
    this.rest = blocks.pop() ?? "";
    return blocks.flatMap((block) => this.parse(block));
  }

  private parse(block: string): ServerEvent[] {
    const event = { type: "message", id: "", data: "" };
    for (const line of block.split(/\r?\n/)) {
      const [, name, value] = /^(\w+): ?(.*)$/.exec(line) ?? [];
      if (name === "event") event.type = value!;
      else if (name === "id") event.id = value!;
      else if (name === "data") event.data += value!;
    }
    return event.data ? [{ ...event, data: JSON.parse(event.data) as Record<string, unknown> }] : [];
  }
}

const AGAIN_MS = 1500;

/** Follow a job until `done`, through restarts of the server: after each one it goes on behind the last event seen. */
export async function followJob(
  id: string,
  onEvent: (event: ServerEvent) => void,
  onConnection: (connected: boolean) => void,
  signal: AbortSignal,
): Promise<void> {
  let last = "";
  while (!signal.aborted) {
    try {
      const reply = await ask(`/v1/jobs/${id}/events`, {
        signal,
        headers: { Accept: "text/event-stream", ...(last ? { "Last-Event-ID": last } : {}) },
      });
      onConnection(true);
      const parser = new EventParser();
      const reader = reply.body!.pipeThrough(new TextDecoderStream()).getReader();
      for (;;) {
        const { done, value } = await reader.read();
        if (done) break;
        for (const event of parser.push(value)) {
          last = event.id || last;
          onEvent(event);
          if (event.type === "done") return;
        }
      }
      if (last && (await ended(id, signal))) return;
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof Error && "status" in error && Number(error.status) >= 400 && Number(error.status) < 500)
        throw error;
      onConnection(false);
    }
    await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
  }
}

/** A stream that ended without `done`: everything was seen before, or the server is stopping. */
async function ended(id: string, signal: AbortSignal): Promise<boolean> {
  const reply = await ask(`/v1/jobs/${id}`, { signal });
  const { status } = (await reply.json()) as { status: string };
  return status !== "accepted" && status !== "running";
}
