import type { Schema } from "../api/types";
import { Field, type FormContext } from "./field";
import { labelOf } from "./schema_kind";

/** Inputs of which exactly one is given: a surface, several together, or all of a package. */
const WAYS: Record<string, string> = {
  mesh: "One surface",
  meshes: "Several together",
  package: "All of a package",
};

export interface Input {
  schema: Schema;
  description: string;
  minOccurs: number;
}

/** Those of the alternatives a process has; none if it does not leave the choice. */
export function waysOf(inputs: Record<string, Input>): string[] {
  const ways = Object.keys(WAYS).filter((name) => inputs[name]?.minOccurs === 0);
  return ways.length > 1 ? ways : [];
}

export function SurfacesInput(props: {
  inputs: Record<string, Input>;
  ways: readonly string[];
  /** The one in use. */
  way: string;
  values: Record<string, unknown>;
  context: FormContext;
  problemOf: (name: string) => string;
  onWay: (way: string) => void;
  onValue: (name: string, value: unknown) => void;
}) {
  const { inputs, ways, way } = props;
  return (
    <fieldset class="stack">
      <legend>Surfaces</legend>
      <div class="row">
        {ways.map((one) => (
          <label key={one} class="row">
            <input type="radio" name="surfaces-way" checked={one === way} onChange={() => props.onWay(one)} />
            {WAYS[one] ?? labelOf(one)}
          </label>
        ))}
      </div>
      <Field
        key={way}
        name={way}
        schema={{ ...inputs[way]!.schema, description: inputs[way]!.description }}
        required
        value={props.values[way]}
        context={props.context}
        problem={props.problemOf(way)}
        onValue={(value) => props.onValue(way, value)}
      />
    </fieldset>
  );
}
