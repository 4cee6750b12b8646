import { useEffect, useState } from "preact/hooks";
import { ask, SERVER_AWAY, ServerError } from "../api/server";

/** What stands in the way of work, in words; empty if nothing does. */
export interface ServerState {
  severity: "none" | "warn" | "bad";
  message: string;
}

const FINE: ServerState = { severity: "none", message: "" };
const LOOK_MS = 10_000;
const LOOK_AGAIN_MS = 2_000;

export async function findServerState(): Promise<ServerState> {
  try {
    await ask("/readyz");
    return FINE;
  } catch (error) {
    if (error instanceof ServerError && !error.isAway) {
      return { severity: "warn", message: `The server cannot work now; ${error.message.replace(/^Not ready: /, "")}` };
    }
    return {
      severity: "bad",
      message:
        "The server does not answer. What is on this page may be old; it goes on by itself when the server is back.",
    };
  }
}

export function useServerState(): ServerState {
  const [state, setState] = useState(FINE);
  useEffect(() => {
    let timer = 0;
    let gone = false;
    let fine = true;
    const look = async () => {
      clearTimeout(timer);
      const found = await findServerState();
      if (gone) return;
      fine = found.severity === "none";
      setState(found);
      timer = window.setTimeout(look, fine ? LOOK_MS : LOOK_AGAIN_MS);
    };
    // others may notice it first
    const lookNow = () => {
      if (fine) {
        fine = false;
        void look();
      }
    };
    void look();
    addEventListener(SERVER_AWAY, lookNow);
    return () => {
      gone = true;
      removeEventListener(SERVER_AWAY, lookNow);
      clearTimeout(timer);
    };
  }, []);
  return state;
}

export function ServerBanner({ state }: { state: ServerState }) {
  return (
    <div role="status" aria-live="polite">
      {state.message && <div class={`banner ${state.severity}`}>{state.message}</div>}
    </div>
  );
}
