import { NumberInput } from "./number_input";

/** A number for each name, such as a depth for each layer; one that is left empty keeps what holds without it. */
export function NumbersByName(props: {
  of: string;
  values: Record<string, number>;
  names: readonly string[];
  min?: number | undefined;
  max?: number | undefined;
  whole?: boolean;
  onValues: (values: Record<string, number>) => void;
}) {
  const { values, onValues } = props;
  const names = [...new Set([...props.names, ...Object.keys(values)])];
  return (
    <div class="row">
      {names.length === 0 && <p class="muted small">Choose surfaces first; each gets a field here.</p>}
      {names.map((name) => (
        <label key={name} class="row small">
          {name}
          <NumberInput
            label={`${props.of}: ${name}`}
            value={values[name]}
            min={props.min}
            max={props.max}
            whole={props.whole ?? false}
            onValue={(value) => {
              const { [name]: _, ...rest } = values;
              onValues(value === undefined ? rest : { ...rest, [name]: value });
            }}
          />
        </label>
      ))}
    </div>
  );
}
