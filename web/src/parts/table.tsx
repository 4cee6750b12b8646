import type { ComponentChildren } from "preact";

export interface Column<Row> {
  title: ComponentChildren;
  /** Said to those who listen; to the eye the cells say it. */
  silent?: boolean;
  kind?: "number" | "name" | "small" | "mono" | "prose";
  cell: (row: Row, place: number) => ComponentChildren;
}

/** Rows under headings; wider than its place, it is moved sideways by itself and not the page with it. */
export function Table<Row>(props: {
  columns: readonly Column<Row>[];
  rows: readonly Row[];
  keyOf: (row: Row, place: number) => string | number;
  rowClass?: (row: Row) => string;
  class?: string;
}) {
  const { columns, rows } = props;
  return (
    <div class="scroll-x">
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
          {rows.map((row, place) => (
            <tr key={props.keyOf(row, place)} class={props.rowClass?.(row) ?? ""}>
              {columns.map(({ kind, cell }, at) => (
                <td key={at} class={kind ?? ""}>
                  {cell(row, place)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
