/** What no control is made for, as the server takes it. */
export function JsonInput(props: { id: string; value: unknown; fallback: unknown; onValue: (value: unknown) => void }) {
  return (
    <textarea
      id={props.id}
      rows={3}
      defaultValue={props.value === undefined ? "" : JSON.stringify(props.value)}
      placeholder={JSON.stringify(props.fallback)}
      onChange={(event) => {
        const text = event.currentTarget.value.trim();
        try {
          props.onValue(text ? JSON.parse(text) : undefined);
          event.currentTarget.setCustomValidity("");
        } catch {
          event.currentTarget.setCustomValidity("This is no JSON.");
          event.currentTarget.reportValidity();
        }
      }}
    />
  );
}
