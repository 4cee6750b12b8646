import type { Job, MeshInfo, Schema } from "../api/types";
import type { Bounds } from "../mesh/triangles";
import { plain } from "../words";
import { Control } from "./control";
import { type Kind, kindOf, labelOf } from "./schema_kind";
import type { Region } from "./values";

/** What controls may need to know besides their own value. */
export interface FormContext {
  meshes: readonly MeshInfo[];
  jobs: readonly Job[];
  layers: readonly string[];
  /** Names of the surfaces the job will have, as far as they are known. */
  surfaces: readonly string[];
  arrays: readonly string[];
  /** Of the volume that was chosen. */
  labels: readonly number[];
  bounds: Bounds | null;
  /** Another one for another mesh. */
  findEars: (() => Promise<Region[]>) | null;
  onLook: (point: [number, number, number]) => void;
  /** Boxes to be shown that are not the user's. */
  onPreview: (regions: Region[]) => void;
}

export interface FieldProps {
  name: string;
  schema: Schema;
  required: boolean;
  value: unknown;
  context: FormContext;
  problem?: string | undefined;
  onValue: (value: unknown) => void;
}

const REFERENCES: readonly Kind[] = ["reference", "package", "volume", "field", "coil"];
const LABELLED: readonly Kind[] = [...REFERENCES, "choice", "number", "text", "words", "json"];

export function Field(props: FieldProps) {
  const { name, schema, problem } = props;
  const kind = kindOf(schema);
  const id = `input-${name}`;
  const title = labelOf(name);
  const hint = sayHint(schema.description ?? "");
  return (
    <div class="field">
      {kind === "flag" ? (
        <label class="row">
          <Control {...props} kind={kind} id={id} />
          {title}
        </label>
      ) : (
        <>
          {LABELLED.includes(kind) ? <label for={id}>{title}</label> : <h3>{title}</h3>}
          <Control {...props} kind={kind} id={id} />
        </>
      )}
      {hint && kind !== "reference" && kind !== "package" && <p class="muted small">{hint}</p>}
      {problem && (
        <p class="note bad small" role="alert">
          {problem}
        </p>
      )}
    </div>
  );
}

/** For people: patterns are for programs (a name that breaks one is refused in words), and so is null. */
function sayHint(description: string): string {
  return plain(description)
    .replace(/ Keys match \S+$/, "")
    .replace(/\bnull\b/g, "left out");
}
