/** A number that may be left out; what cannot be read as a number counts as left out. */
export function NumberInput(props: {
  id?: string;
  label?: string;
  value: number | undefined;
  placeholder?: string | undefined;
  min?: number | undefined;
  max?: number | undefined;
  whole?: boolean;
  onValue: (value: number | undefined) => void;
}) {
  return (
    <input
      id={props.id}
      type="number"
      aria-label={props.label}
      value={props.value ?? ""}
      placeholder={props.placeholder}
      min={props.min}
      max={props.max}
      step={props.whole ? 1 : "any"}
      onChange={(event) => {
        const read = event.currentTarget.valueAsNumber;
        props.onValue(Number.isNaN(read) ? undefined : read);
      }}
    />
  );
}
