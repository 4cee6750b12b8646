import { useCallback, useEffect, useState } from "preact/hooks";

export interface Loaded<T> {
  value: T | null;
  error: unknown;
  loading: boolean;
  again: () => void;
}

/** Something asked of the server; asked anew when `what` changes. */
export function useLoaded<T>(what: string, load: (signal: AbortSignal) => Promise<T>): Loaded<T> {
  const [state, setState] = useState<{ what: string; value: T | null; error: unknown }>({
    what: "",
    value: null,
    error: null,
  });
  const [turn, setTurn] = useState(0);
  // `what` names all that `load` depends on
  useEffect(() => {
    const aborter = new AbortController();
    load(aborter.signal).then(
      (value) => !aborter.signal.aborted && setState({ what, value, error: null }),
      (error) => !aborter.signal.aborted && setState({ what, value: null, error }),
    );
    return () => aborter.abort();
  }, [what, turn]);
  const again = useCallback(() => setTurn((turn) => turn + 1), []);
  const current = state.what === what;
  return { value: current ? state.value : null, error: current ? state.error : null, loading: !current, again };
}
