import { NumberInput } from "./number_input";

/** A depth for each layer; one that is left empty keeps the layer's own. */
export function DepthsInput(props: {
  of: string;
  depths: Record<string, number>;
  layers: readonly string[];
  onDepths: (depths: Record<string, number>) => void;
}) {
  const { depths, layers, onDepths } = props;
  const names = [...new Set([...layers, ...Object.keys(depths)])];
  return (
    <div class="row">
      {names.map((name) => (
        <label key={name} class="row small">
          {name}
          <NumberInput
            label={`${props.of}: depth of ${name} in mm`}
            value={depths[name]}
            min={0}
            max={100}
            onValue={(value) => {
              const { [name]: _, ...rest } = depths;
              onDepths(value === undefined ? rest : { ...rest, [name]: value });
            }}
          />
        </label>
      ))}
    </div>
  );
}
