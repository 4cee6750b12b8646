import { readCoil } from "../mesh/coil";
import { SHOWN_FACES } from "../mesh/thin_out";
import type { ReadMesh } from "../mesh/worker";
import { readMesh, readSolved } from "../mesh/workshop";
import { type Page, upTo } from "./pages";
import { ask, askJson } from "./server";
import type { MeshInfo, Vector } from "./types";

/** Meshes of the server, and their triangles; those looked at last are kept. */

const KEPT = 12;
const kept = new Map<string, Promise<ReadMesh>>();

export function listMeshes(count: number, search: string, signal: AbortSignal): Promise<Page<MeshInfo>> {
  return upTo(count, async (part) => {
    if (search) part.set("q", search);
    const { meshes, next } = await askJson<{ meshes: MeshInfo[]; next?: string }>(`/v1/meshes?${part}`, { signal });
    return { items: meshes, next };
  });
}

export async function deleteMesh(id: string): Promise<void> {
  await ask(`/v1/meshes/${id}`, { method: "DELETE" });
}

/** The boxes that `ears: "auto"` would take. */
export async function findEars(id: string): Promise<{ name: string; box_mm: { min: Vector; max: Vector } }[]> {
  const { ears } = await askJson<{ ears: { name: string; box_mm: { min: Vector; max: Vector } }[] }>(
    `/v1/meshes/${id}/ears`,
  );
  return ears;
}

/** Where the dipoles and wires of an uploaded coil are, in its own coordinates in mm. */
export async function fetchCoil(path: string, signal: AbortSignal): Promise<Float32Array> {
  const reply = await ask(`${path}/file?format=original`, { signal });
  return readCoil(await reply.text());
}

/** `href` is a reference as jobs take it: `/v1/meshes/{id}` or `/v1/jobs/{id}/results/{output}`. */
export function fetchTriangles(href: string): Promise<ReadMesh> {
  let found = kept.get(href);
  if (!found) {
    found = fetchNow(href);
    found.catch(() => kept.delete(href));
  }
  kept.delete(href);
  kept.set(href, found); // the last one is the freshest
  for (const oldest of kept.keys()) if (kept.size > KEPT) kept.delete(oldest);
  return found;
}

async function fetchNow(href: string): Promise<ReadMesh> {
  if (!href.includes("/v1/meshes/")) {
    const reply = await ask(`${href}?most_faces=${SHOWN_FACES}`);
    const mesh = await readMesh(await reply.arrayBuffer(), "stl");
    const faces = Number(reply.headers.get("Integument-Faces"));
    return faces > 0 ? { ...mesh, faces, thinned: true, closed: false } : mesh;
  }
  const { faces } = await askJson<MeshInfo>(href);
  const reply = await ask(`${href}/file?format=ply&most_faces=${SHOWN_FACES}`);
  const mesh = await readMesh(await reply.arrayBuffer(), "ply");
  return faces > SHOWN_FACES ? { ...mesh, faces, thinned: true, closed: false } : mesh; // the server thinned it
}

/** The surfaces of a solver's field with a number per face; `counts`: name -> faces of each, in the order of the file. */
export async function fetchField(
  path: string,
  counts: Record<string, number>,
  signal: AbortSignal,
): Promise<Record<string, ReadMesh>> {
  const all = Object.values(counts).reduce((sum, count) => sum + count, 0);
  const reply = await ask(all > SHOWN_FACES ? `${path}?most_faces=${SHOWN_FACES}` : path, { signal });
  const meshes = await readSolved(await reply.arrayBuffer());
  if (meshes.length !== Object.keys(counts).length) throw new Error("The file of the field does not fit its report.");
  return Object.fromEntries(
    Object.entries(counts).map(([name, faces], place) => {
      const mesh = meshes[place]!;
      const thinned = mesh.faces < faces;
      return [name, { ...mesh, faces, thinned, closed: mesh.closed && !thinned }];
    }),
  );
}
