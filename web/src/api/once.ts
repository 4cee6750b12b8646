import { askJson, isPassing } from "./server";

/** Requests that make something: however often one is sent, because its answer was lost, the server makes one. */

const unanswered = new Map<string, string>(); // request -> its key

/** `request` is all that tells this request from others; `send` gets the header that goes with it. */
async function once<T>(request: string, send: (headers: Record<string, string>) => Promise<T>): Promise<T> {
  const key = unanswered.get(request) ?? newKey();
  unanswered.set(request, key);
  try {
    const answer = await send({ "Idempotency-Key": key });
    unanswered.delete(request);
    return answer;
  } catch (error) {
    if (!isPassing(error)) unanswered.delete(request);
    throw error;
  }
}

export function sendOnce<T>(path: string, content: unknown): Promise<T> {
  const body = JSON.stringify(content);
  return once(path + body, (headers) =>
    askJson<T>(path, { method: "POST", body, headers: { "Content-Type": "application/json", ...headers } }),
  );
}

/** 128 random bits. Not by `crypto.randomUUID`, which a browser has only for https and its own machine. */
function newKey(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
