import type { ReadMesh } from "../mesh/worker";
import { sayCount } from "../words";

/** Says so where not all faces are shown. */
export function ThinnedNote({ meshes }: { meshes: readonly ReadMesh[] }) {
  const thinned = meshes.filter((mesh) => mesh.thinned);
  if (thinned.length === 0) return null;
  const sum = (count: (mesh: ReadMesh) => number) => thinned.reduce((total, mesh) => total + count(mesh), 0);
  return (
    <p class="muted small">
      {sayCount(sum((mesh) => mesh.faces))} faces are shown by {sayCount(sum((mesh) => mesh.shown.faces.length / 3))}.
      Jobs work on all of them.
    </p>
  );
}
