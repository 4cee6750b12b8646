import { MeshBVH, type SerializedBVH } from "three-mesh-bvh";
import { curvatureField, distanceField, qualityField } from "./fields";
import { readMsh } from "./msh";
import { readObj } from "./obj";
import { readPly } from "./ply";
import { readStl } from "./stl";
import { thinOut } from "./thin_out";
import { treeOf } from "./tree";
import { boundsOf, isClosed, type Triangles, volumeOf } from "./triangles";

/** What takes longer than a frame: reading meshes and measuring them. Runs beside the page, which stays alive. */

export type FileKind = "stl" | "ply" | "obj";
export type FieldKind = "quality" | "curvature" | "distance";

export type Task =
  | { kind: "read"; data: ArrayBuffer; format: FileKind }
  | { kind: "solved"; data: ArrayBuffer }
  | { kind: "field"; field: FieldKind; mesh: Triangles; to: Triangles | null }
  | { kind: "tree"; mesh: Triangles };

export interface ReadMesh {
  shown: Triangles;
  faces: number;
  thinned: boolean;
  closed: boolean;
  volume_mm3: number;
  /** Of a solver's field in V/m, a number per face of `shown`; NaN where it has none. */
  magnitudes?: Float32Array;
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

/** As they come: the server thins a field, so that every face keeps a number of its own. */
function solved(data: ArrayBuffer): ReadMesh[] {
  return readMsh(data).map(({ mesh, values }) => ({
    shown: mesh,
    faces: mesh.faces.length / 3,
    thinned: false,
    closed: isClosed(mesh),
    volume_mm3: volumeOf(mesh),
    magnitudes: values,
    ...boundsOf(mesh.positions),
  }));
}

function field(task: Extract<Task, { kind: "field" }>): Float32Array {
  if (task.field === "quality") return qualityField(task.mesh);
  if (task.field === "curvature") return curvatureField(task.mesh);
  return distanceField(task.mesh, task.to!);
}

/** Without the index, which the page has. */
function tree(mesh: Triangles): SerializedBVH {
  return { ...MeshBVH.serialize(treeOf(mesh), { cloneBuffers: false }), index: new Uint32Array() };
}

/** The answer, and its memory, which goes with it instead of being copied. */
function answerTo(task: Task): [result: unknown, moved: unknown[]] {
  if (task.kind === "read") {
    const result = read(task.data, task.format);
    return [result, [result.shown.positions.buffer, result.shown.faces.buffer]];
  }
  if (task.kind === "solved") {
    const result = solved(task.data);
    const moved = result.flatMap(({ shown, magnitudes }) => [shown.positions, shown.faces, magnitudes!]);
    return [result, moved.map((array) => array.buffer)];
  }
  if (task.kind === "tree") {
    const result = tree(task.mesh);
    return [result, [...result.roots, result.indirectBuffer?.buffer].filter(Boolean)];
  }
  const values = field(task);
  return [values, [values.buffer]];
}

addEventListener("message", (event: MessageEvent<{ id: number; task: Task }>) => {
  const { id, task } = event.data;
  try {
    const [result, moved] = answerTo(task);
    postMessage({ id, result }, { transfer: moved as Transferable[] });
  } catch (error) {
    postMessage({ id, error: error instanceof Error ? error.message : String(error) });
  }
});
