import type { Column } from "../parts/table";

export function RemoveButton(props: { what: string; disabled?: boolean; onRemove: () => void }) {
  return (
    <button
      type="button"
      class="quiet"
      aria-label={`Remove ${props.what}`}
      disabled={props.disabled ?? false}
      onClick={props.onRemove}
    >
      ✕
    </button>
  );
}

/** The last column of a table whose rows can be taken away. */
export function removeColumn<Row>(
  whatOf: (row: Row) => string,
  onRemove: (row: Row) => void,
  disabled = false,
): Column<Row> {
  return {
    title: "Remove",
    silent: true,
    cell: (row) => <RemoveButton what={whatOf(row)} disabled={disabled} onRemove={() => onRemove(row)} />,
  };
}
