import type { FieldKind, ReadMesh } from "../mesh/worker";
import { measureField } from "../mesh/workshop";
import { usualRange } from "../viewer/colour_map";
import type { Field } from "../viewer/surface";

/** What surfaces can be coloured by. `distance` needs another surface to measure to, `magnitude` comes from a solver. */
export interface FieldChoice {
  kind: FieldKind | "magnitude";
  to: string | null;
}

export function fieldTitle({ kind, to }: FieldChoice): string {
  if (kind === "distance") return `Distance to ${to}`;
  return { magnitude: "Magnitude of the field", quality: "Triangle quality", curvature: "Mean curvature" }[kind];
}

export const MAGNITUDE: FieldChoice = { kind: "magnitude", to: null };

const known = new WeakMap<object, Map<string, Promise<Float32Array>>>();

export async function makeField(choice: FieldChoice, mesh: ReadMesh, to: ReadMesh | null): Promise<Field> {
  if (choice.kind === "magnitude") return magnitudeOf(mesh);
  const key = `${choice.kind} ${choice.to}`;
  const ofMesh = known.get(mesh.shown) ?? new Map<string, Promise<Float32Array>>();
  known.set(mesh.shown, ofMesh);
  let measured = ofMesh.get(key);
  if (!measured) {
    measured = measureField(choice.kind, mesh.shown, to?.shown ?? null);
    ofMesh.set(key, measured);
  }
  const values = await measured;
  const [low, high] = usualRange(values);
  const base = { name: fieldTitle(choice), values, each: "vertex" as const };
  if (choice.kind === "quality") return { ...base, unit: "", low: 0, high: 1, map: "viridis" };
  if (choice.kind === "curvature") {
    const most = Math.max(Math.abs(low), Math.abs(high));
    return { ...base, unit: "1/mm", low: -most, high: most, map: "signed" };
  }
  return { ...base, unit: "mm", low: Math.min(low, 0), high, map: "viridis" };
}

function magnitudeOf({ magnitudes, shown }: ReadMesh): Field {
  const values = magnitudes ?? new Float32Array(shown.faces.length / 3).fill(Number.NaN);
  const [, high] = usualRange(values);
  return { name: fieldTitle(MAGNITUDE), unit: "V/m", values, each: "face", low: 0, high, map: "viridis" };
}
