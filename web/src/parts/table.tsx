import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";

export interface Column<Row> {
  title: ComponentChildren;
  /** Said to those who listen; to the eye the cells say it. */
  silent?: boolean;
  kind?: "number" | "name" | "small" | "mono" | "prose";
  cell: (row: Row, number: number) => ComponentChildren;
}

/** Rows under headings; wider than its place, it is moved sideways by itself and not the page with it. */
export function Table<Row>(props: {
  columns: readonly Column<Row>[];
  rows: readonly Row[];
  keyOf: (row: Row, number: number) => string | number;
  rowClass?: (row: Row) => string;
  class?: string;
}) {
  const { columns, rows } = props;
  const [place, wide] = useWide();
  return (
    // what is wider than its place is reached, and moved, by keys, too
    <div class="scroll-x" ref={place} {...(wide ? { tabIndex: 0, role: "group", "aria-label": "Wide table" } : {})}>
      <table class={props.class ?? ""}>
        <thead>
          <tr>
            {columns.map(({ title, silent, kind }, at) => (
              <th key={at} class={kind === "number" ? "number" : ""}>
                {silent ? <span class="hidden-label">{title}</span> : title}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row, number) => (
            <tr key={props.keyOf(row, number)} class={props.rowClass?.(row) ?? ""}>
              {columns.map(({ kind, cell }, at) => (
                <td key={at} class={kind ?? ""}>
                  {cell(row, number)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** Whether what stands in a place is wider than it, now and when either changes. */
function useWide() {
  const place = useRef<HTMLDivElement>(null);
  const [wide, setWide] = useState(false);
  useEffect(() => {
    const { current } = place;
    if (!current) return;
    const sizes = new ResizeObserver(() => setWide(current.scrollWidth > current.clientWidth));
    for (const one of [current, ...current.children]) sizes.observe(one);
    return () => sizes.disconnect();
  }, []);
  return [place, wide] as const;
}
