import type { Field } from "../viewer/surface";
import { type FieldChoice, fieldTitle, MAGNITUDE } from "./field_choice";
import { Legend } from "./legend";

/** Colour the surfaces by a number: thickness, deviation, curvature, quality. */
export function FieldControl(props: {
  names: readonly string[];
  /** Whether the surfaces have a solver's field. */
  solved: boolean;
  /** Whether any is shown by fewer faces than it has. */
  thinned: boolean;
  choice: FieldChoice | null;
  field: Field | null;
  failure: string;
  onChoice: (choice: FieldChoice | null) => void;
  onRange: (low: number, high: number) => void;
}) {
  const { names, choice, field } = props;
  const choices: FieldChoice[] = [
    ...(props.solved ? [MAGNITUDE] : []),
    ...(names.length > 1 ? names.map((to) => ({ kind: "distance" as const, to })) : []),
    { kind: "curvature", to: null },
    { kind: "quality", to: null },
  ];
  return (
    <div class="stack">
      <div class="field">
        <label for="field">Colours</label>
        <select
          id="field"
          value={choice ? fieldTitle(choice) : ""}
          onChange={(event) =>
            props.onChoice(choices.find((one) => fieldTitle(one) === event.currentTarget.value) ?? null)
          }
        >
          <option value="">One per tissue</option>
          {choices.map((one) => (
            <option key={fieldTitle(one)}>{fieldTitle(one)}</option>
          ))}
        </select>
      </div>
      {choice && !field && !props.failure && <p class="muted small">Measuring…</p>}
      {props.failure && <p class="note bad">{props.failure}</p>}
      {field && <Legend field={field} onRange={props.onRange} />}
      {field && choice?.kind === "magnitude" && (
        <p class="muted small">
          {props.thinned
            ? "Shown by fewer triangles, each with the value of one that lies there: numbers of all are in the report and the files. "
            : "One value per triangle. "}
          Grey where there is none. Point at a surface to read it.
        </p>
      )}
      {field && choice?.kind === "distance" && (
        <p class="muted small">
          Measured from every vertex to the nearest point of {choice.to}. Point at a surface to read it.
        </p>
      )}
    </div>
  );
}
