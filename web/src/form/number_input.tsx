import { useEffect, useState } from "preact/hooks";

/** A number that may be left out; what cannot be read as a number counts as left out. What is typed stays as typed;
 * when the focus leaves, the value is shown that the part around it has kept. */
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
  const { value } = props;
  const [text, setText] = useState(textOf(value));
  const settle = () => setText((typed) => (readNumber(typed) === value ? typed : textOf(value)));
  useEffect(settle, [value]);
  return (
    <input
      id={props.id}
      type="number"
      aria-label={props.label}
      value={text}
      placeholder={props.placeholder}
      min={props.min}
      max={props.max}
      step={props.whole ? 1 : "any"}
      onInput={(event) => {
        setText(event.currentTarget.value);
        props.onValue(readNumber(event.currentTarget.value));
      }}
      onBlur={settle}
    />
  );
}

function textOf(value: number | undefined | null): string {
  return value === undefined || value === null ? "" : String(value);
}

function readNumber(text: string): number | undefined {
  const read = Number.parseFloat(text);
  return Number.isNaN(read) ? undefined : read;
}
