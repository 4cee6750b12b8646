import type { SerializedBVH } from "three-mesh-bvh";
import type { Triangles } from "./triangles";
import type { FieldKind, FileKind, ReadMesh, Task } from "./worker";
import MeshWorker from "./worker?worker";

/** The page's side of the worker: promises in, answers out. */

interface Waiting {
  resolve: (value: never) => void;
  reject: (error: Error) => void;
}

let worker: Worker | null = null;
let last = 0;
const waiting = new Map<number, Waiting>();

function hired(): Worker {
  if (worker) return worker;
  worker = new MeshWorker();
  worker.onmessage = (event: MessageEvent<{ id: number; result?: unknown; error?: string }>) => {
    const { id, result, error } = event.data;
    const one = waiting.get(id);
    waiting.delete(id);
    if (error !== undefined) one?.reject(new Error(error));
    else one?.resolve(result as never);
  };
  worker.onerror = (event) => {
    for (const one of waiting.values())
      one.reject(new Error(event.message || "The mesh is too large for this browser."));
    waiting.clear();
    worker = null;
  };
  return worker;
}

function hand<T>(task: Task, moved: Transferable[] = []): Promise<T> {
  return new Promise<T>((resolve, reject) => {
    const id = ++last;
    waiting.set(id, { resolve: resolve as (value: never) => void, reject });
    hired().postMessage({ id, task }, moved);
  });
}

/** The buffer is handed over and empty afterwards. */
export function readMesh(data: ArrayBuffer, format: FileKind): Promise<ReadMesh> {
  return hand<ReadMesh>({ kind: "read", data, format }, [data]);
}

/** Surfaces with a field; the buffer is empty afterwards. */
export function readSolved(data: ArrayBuffer): Promise<ReadMesh[]> {
  return hand<ReadMesh[]>({ kind: "solved", data }, [data]);
}

/** A copy of the mesh goes to the worker; the page goes on meanwhile. */
export function makeTree(mesh: Triangles): Promise<SerializedBVH> {
  return hand<SerializedBVH>({ kind: "tree", mesh });
}

export function measureField(field: FieldKind, mesh: Triangles, to: Triangles | null): Promise<Float32Array> {
  return hand<Float32Array>({ kind: "field", field, mesh, to });
}
