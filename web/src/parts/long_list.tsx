import { useRef, useState } from "preact/hooks";
import type { Page } from "../api/pages";
import { useLoaded } from "./loaded";

export interface LongList<T> {
  items: readonly T[];
  /** False until the first answer is here. */
  known: boolean;
  loading: boolean;
  error: unknown;
  again: () => void;
  /** Null where all of it is shown. */
  showMore: (() => void) | null;
}

const GROWTH = 4;

/** The beginning of a list of the server's, more of it when asked for; what is there stays until the rest has come. */
export function useLongList<T>(
  what: string,
  load: (count: number, signal: AbortSignal) => Promise<Page<T>>,
  first: number,
): LongList<T> {
  const [count, setCount] = useState(first);
  const list = useLoaded(`${what} ${count}`, (signal) => load(count, signal));
  const before = useRef(list.value);
  if (list.value) before.current = list.value;
  const page = list.value ?? before.current;
  return {
    items: page?.items ?? [],
    known: page !== null,
    loading: list.loading,
    error: list.error,
    again: list.again,
    showMore: page?.next ? () => setCount(count * GROWTH) : null,
  };
}

export function MoreButton({ onMore, loading = false }: { onMore: (() => void) | null; loading?: boolean }) {
  if (!onMore) return null;
  return (
    <div class="row">
      <button type="button" disabled={loading} onClick={onMore}>
        {loading ? "Loading…" : "Show older ones"}
      </button>
    </div>
  );
}
