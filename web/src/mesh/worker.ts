import { curvatureField, distanceField, qualityField } from "./fields";
import { readObj } from "./obj";
import { readPly } from "./ply";
import { readStl } from "./stl";
import { thinOut } from "./thin_out";
import { boundsOf, isClosed, type Triangles, volumeOf } from "./triangles";

/** What takes longer than a frame: reading meshes and measuring them. Runs beside the page, which stays alive. */

export type FileKind = "stl" | "ply" | "obj";
export type FieldKind = "quality" | "curvature" | "distance";

export type Task =
  | { kind: "read"; data: ArrayBuffer; format: FileKind }
  | { kind: "field"; field: FieldKind; mesh: Triangles; to: Triangles | null };

export interface ReadMesh {
  shown: Triangles;
  faces: number;
  thinned: boolean;
  closed: boolean;
  volume_mm3: number;
  min: [number, number, number];
  max: [number, number, number];
}

const READERS = { stl: readStl, ply: readPly, obj: readObj };

function read(data: ArrayBuffer, format: FileKind): ReadMesh {
  const mesh = READERS[format](data);
  const shown = thinOut(mesh);
  return {
    shown,
    faces: mesh.faces.length / 3,
    thinned: shown !== mesh,
    closed: shown === mesh && isClosed(mesh),
    volume_mm3: volumeOf(mesh),
    ...boundsOf(mesh.positions),
  };
}

function field(task: Extract<Task, { kind: "field" }>): Float32Array {
  if (task.field === "quality") return qualityField(task.mesh);
  if (task.field === "curvature") return curvatureField(task.mesh);
  return distanceField(task.mesh, task.to!);
}

addEventListener("message", (event: MessageEvent<{ id: number; task: Task }>) => {
  const { id, task } = event.data;
  try {
    const result = task.kind === "read" ? read(task.data, task.format) : field(task);
    const moved = "shown" in result ? [result.shown.positions.buffer, result.shown.faces.buffer] : [result.buffer];
    postMessage({ id, result }, { transfer: moved as Transferable[] });
  } catch (error) {
    postMessage({ id, error: error instanceof Error ? error.message : String(error) });
  }
});
