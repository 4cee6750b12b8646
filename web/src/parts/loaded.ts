import { useCallback, useEffect, useState } from "preact/hooks";
import { isPassing } from "../api/server";
import { useKeyCount } from "./key_count";

export interface Loaded<T> {
  /** What came last, also where asking again failed. */
  value: T | null;
  error: unknown;
  loading: boolean;
  again: () => void;
}

const AGAIN_MS = 2000;

/** Something asked of the server; asked anew when `what` or the key changes, and by itself until the server is back. */
export function useLoaded<T>(what: string, load: (signal: AbortSignal) => Promise<T>): Loaded<T> {
  const [state, setState] = useState<{ what: string; value: T | null; error: unknown }>({
    what: "",
    value: null,
    error: null,
  });
  const [turn, setTurn] = useState(0);
  const again = useCallback(() => setTurn((turn) => turn + 1), []);
  const keys = useKeyCount();
  // `what` names all that `load` depends on
  useEffect(() => {
    const aborter = new AbortController();
    let timer = 0;
    load(aborter.signal).then(
      (value) => !aborter.signal.aborted && setState({ what, value, error: null }),
      (error) => {
        if (aborter.signal.aborted) return;
        setState((before) => ({ what, value: before.what === what ? before.value : null, error }));
        if (isPassing(error)) timer = window.setTimeout(again, AGAIN_MS);
      },
    );
    return () => {
      aborter.abort();
      clearTimeout(timer);
    };
  }, [what, turn, keys]);
  const current = state.what === what;
  return { value: current ? state.value : null, error: current ? state.error : null, loading: !current, again };
}
