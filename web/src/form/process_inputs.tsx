import { useState } from "preact/hooks";
import { ServerError } from "../api/server";
import { Field, type FormContext } from "./field";
import { type Input, SurfacesInput, waysOf } from "./surfaces_input";

const RARE: readonly string[] = ["conductivities_s_per_m"];

/** All inputs of a process, but those of `without`. Of inputs that exclude each other one is shown. */
export function ProcessInputs(props: {
  inputs: Record<string, Input>;
  values: Record<string, unknown>;
  without?: readonly string[];
  context: FormContext;
  error: unknown;
  onValues: (values: Record<string, unknown>) => void;
}) {
  const { inputs, values, without = [], context } = props;
  const ways = waysOf(inputs).filter((name) => !without.includes(name));
  const [chosen, setChosen] = useState("");
  const given = ways.find((name) => values[name] !== undefined && values[name] !== null);
  const way = ways.includes(chosen) ? chosen : (given ?? ways[0] ?? "");
  const problemOf = (name: string) => problemsOf(props.error, name);
  const set = (name: string, value: unknown) => props.onValues({ [name]: value });
  const change = (to: string) => {
    setChosen(to);
    props.onValues(Object.fromEntries(ways.filter((name) => name !== to).map((name) => [name, undefined])));
  };
  return (
    <section class="card stack" aria-label="Inputs">
      {ways.length > 0 && without.length === 0 && (
        <SurfacesInput
          inputs={inputs}
          ways={ways}
          way={way}
          values={values}
          context={context}
          problemOf={problemOf}
          onWay={change}
          onValue={set}
        />
      )}
      {inOrder(inputs)
        .filter(([name]) => !ways.includes(name) && !without.includes(name))
        .map(([name, one]) => (
          <Field
            key={name}
            name={name}
            schema={{ ...one.schema, description: one.description || one.schema.description || "" }}
            required={one.minOccurs > 0}
            value={values[name]}
            context={context}
            problem={problemOf(name)}
            onValue={(value) => set(name, value)}
          />
        ))}
    </section>
  );
}

/** What must be given first; what has a good value for nearly everybody last; else as the process has them. */
function inOrder(inputs: Record<string, Input>): [string, Input][] {
  const rank = ([name, one]: [string, Input]) => (one.minOccurs > 0 ? 0 : RARE.includes(name) ? 2 : 1);
  return Object.entries(inputs).sort((a, b) => rank(a) - rank(b));
}

/** What the server said about one input. */
function problemsOf(error: unknown, name: string): string {
  const problems = error instanceof ServerError ? (error.problem?.errors ?? []) : [];
  return problems
    .filter((one) => one.pointer?.split("/").includes(name))
    .map((one) => one.detail)
    .join(" ");
}
