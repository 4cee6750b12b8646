import { useEffect, useState } from "preact/hooks";

const SETTLE_MS = 300;

export interface Search {
  typed: string;
  settled: string;
  type: (text: string) => void;
}

/** What is typed, and what was typed a moment ago: the server is asked when the hand rests. */
export function useSettled(first: string): Search {
  const [typed, type] = useState(first);
  const [settled, setSettled] = useState(first);
  useEffect(() => {
    const timer = setTimeout(() => setSettled(typed.trim().slice(0, 200)), SETTLE_MS);
    return () => clearTimeout(timer);
  }, [typed]);
  return { typed, settled, type };
}

export function SearchBox({ label, search }: { label: string; search: Search }) {
  return (
    <label class="row">
      <span class="hidden-label">{label}</span>
      <input
        type="search"
        placeholder={label}
        value={search.typed}
        maxLength={200}
        onInput={(event) => search.type(event.currentTarget.value)}
      />
    </label>
  );
}
