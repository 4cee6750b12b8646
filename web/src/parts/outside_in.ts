import type { ReadMesh } from "../mesh/worker";

/** Names of surfaces from outside inwards, which is also the order they are drawn in: by the volume they enclose. */
export function outsideIn(meshes: Record<string, ReadMesh>): string[] {
  const volume = (name: string) => Math.abs(meshes[name]!.volume_mm3);
  return Object.keys(meshes).sort((a, b) => volume(b) - volume(a));
}
