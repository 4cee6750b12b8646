/** Takes a row away; stands in the last column of a table. */
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

/** The heading of that column. */
export function RemoveHeading() {
  return (
    <th>
      <span class="hidden-label">Remove</span>
    </th>
  );
}
