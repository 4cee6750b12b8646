import { useCallback, useEffect, useState } from "preact/hooks";
import { ServerError } from "../api/server";
import { useKeyCount } from "./key_count";

const LOOK_MS = 2000;

/** What the server says now, and again while `pauseOf` names a pause in ms; null: it has come to its end. */
export function usePolled<T>(
  what: string,
  load: (signal: AbortSignal) => Promise<T>,
  pauseOf: (value: T) => number | null = () => LOOK_MS,
): { value: T | null; error: unknown; again: () => void } {
  const [value, setValue] = useState<T | null>(null);
  const [error, setError] = useState<unknown>(null);
  const [turn, setTurn] = useState(0);
  const keys = useKeyCount();
  // `what` names all that `load` depends on
  useEffect(() => {
    const aborter = new AbortController();
    let timer = 0;
    const look = async () => {
      let pause: number | null = LOOK_MS;
      try {
        const found = await load(aborter.signal);
        if (aborter.signal.aborted) return;
        setValue(found);
        setError(null);
        pause = pauseOf(found);
      } catch (reason) {
        if (aborter.signal.aborted) return;
        setError(reason);
        if (reason instanceof ServerError && reason.wantsKey) pause = null; // another key starts it again
      }
      if (pause !== null) timer = window.setTimeout(look, pause);
    };
    void look();
    return () => {
      aborter.abort();
      clearTimeout(timer);
    };
  }, [what, turn, keys]);
  return { value, error, again: useCallback(() => setTurn((turn) => turn + 1), []) };
}
