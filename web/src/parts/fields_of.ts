import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/server";
import type { ReadMesh } from "../mesh/worker";
import type { Field } from "../viewer/surface";
import { type FieldChoice, MAGNITUDE, makeField } from "./field_choice";

/** By what surfaces are coloured: what was chosen, and the numbers of each surface as they come. */
export function useFields(meshes: Record<string, ReadMesh>) {
  const [choice, choose] = useState<FieldChoice | null>(null);
  const [fields, setFields] = useState<Record<string, Field>>({});
  const [range, setRange] = useState<[number, number] | null>(null);
  const [failure, setFailure] = useState("");
  const solved = Object.values(meshes).some((mesh) => mesh.magnitudes);
  useEffect(() => choose(solved ? MAGNITUDE : null), [solved]); // what the job was asked for is seen at once
  useEffect(() => {
    setFields({});
    setRange(null);
    setFailure("");
    if (!choice) return;
    let gone = false;
    const found: Record<string, Field> = {};
    const to = choice.to ? (meshes[choice.to] ?? null) : null;
    for (const [name, mesh] of Object.entries(meshes)) {
      if (name === choice.to) continue;
      makeField(choice, mesh, to).then(
        (field) => {
          found[name] = field;
          if (!gone) setFields({ ...found });
        },
        (error) => !gone && setFailure(messageOf(error)),
      );
    }
    return () => {
      gone = true;
    };
  }, [choice, meshes]);
  return { choice, choose, fields, range, setRange, solved, failure };
}
