import { type Camera, DoubleSide, type Plane, Ray, Raycaster, Vector2, Vector3 } from "three";
import { MeshBVH, type SerializedBVH } from "three-mesh-bvh";
import type { Triangles } from "../mesh/triangles";
import type { Shell } from "./shell";
import type { Probe } from "./surface";

/** Makes the search tree of a mesh, beside the page where there is somebody to do it. */
export type TreeMaker = (mesh: Triangles) => Promise<SerializedBVH>;

const trees = new WeakMap<object, MeshBVH | Promise<void>>();

/** The tree of a shell; null while somebody makes it. */
function treeOf(shell: Shell, makeTree: TreeMaker | undefined): MeshBVH | null {
  const { geometry } = shell;
  const known = trees.get(geometry);
  if (known) return known instanceof MeshBVH ? known : null;
  if (makeTree) {
    const made = makeTree(shell.surface.mesh).then((told) => {
      trees.set(geometry, MeshBVH.deserialize(told, geometry, { setIndex: false }));
    });
    made.catch(() => {}); // what has no tree is not looked under; asking again would fail again
    trees.set(geometry, made);
    return null;
  }
  const tree = new MeshBVH(geometry, { indirect: true });
  trees.set(geometry, tree);
  return tree;
}

/** What lies under a place of the canvas (-1 to 1, y upwards); the side that is cut away does not count. */
export function pick(
  shells: readonly Shell[],
  camera: Camera,
  x: number,
  y: number,
  plane: Plane | null,
  makeTree?: TreeMaker,
): Probe | null {
  const caster = new Raycaster();
  caster.setFromCamera(new Vector2(x, y), camera);
  const cut = plane && inSection(shells, caster.ray, plane, makeTree);
  if (cut) return cut;
  let nearest: { distance: number; probe: Probe } | null = null;
  for (const shell of shells) {
    if (!shell.group.visible) continue;
    const tree = treeOf(shell, makeTree);
    if (!tree) continue;
    for (const hit of tree.raycast(caster.ray, shell.body.material)) {
      if (plane && plane.distanceToPoint(hit.point) < 0) continue;
      if (nearest && hit.distance >= nearest.distance) continue;
      nearest = {
        distance: hit.distance,
        probe: {
          surface: shell.surface.name,
          point: hit.point.toArray(),
          value: valueAt(shell, hit.faceIndex!, hit.point),
        },
      };
    }
  }
  return nearest?.probe ?? null;
}

/** The innermost filled surface where the ray meets the plane from the side that is cut away; null where it meets none. */
function inSection(shells: readonly Shell[], ray: Ray, plane: Plane, makeTree: TreeMaker | undefined): Probe | null {
  const point = plane.distanceToPoint(ray.origin) < 0 ? ray.intersectPlane(plane, new Vector3()) : null;
  if (!point) return null;
  const beyond = new Ray(point, ray.direction);
  const around = shells.filter((shell) => {
    if (!shell.group.visible || !shell.surface.closed) return false;
    const crossings = treeOf(shell, makeTree)?.raycast(beyond, DoubleSide) ?? [];
    return crossings.length % 2 === 1; // an odd number of faces lies between a place inside and the far away
  });
  const innermost = around.at(-1);
  return innermost ? { surface: innermost.surface.name, point: point.toArray(), value: null, inSection: true } : null;
}

/** The field of the surface there: the number of the face, or linear within it; null where a corner has no value. */
function valueAt(shell: Shell, face: number, point: Vector3): number | null {
  const { field, mesh } = shell.surface;
  if (!field) return null;
  if (field.each === "face") return known(field.values[face]!);
  const corners = [0, 1, 2].map((k) => mesh.faces[3 * face + k]!);
  const [a, b, c] = corners.map((v) => new Vector3().fromArray(mesh.positions, 3 * v)) as [Vector3, Vector3, Vector3];
  const area = (p: Vector3, q: Vector3) =>
    new Vector3().subVectors(p, point).cross(new Vector3().subVectors(q, point)).length();
  const shares = [area(b, c), area(c, a), area(a, b)];
  const sum = shares[0]! + shares[1]! + shares[2]!;
  const value =
    sum === 0
      ? field.values[corners[0]!]!
      : corners.reduce((mean, v, k) => mean + (shares[k]! / sum) * field.values[v]!, 0);
  return known(value);
}

function known(value: number): number | null {
  return Number.isNaN(value) ? null : value;
}
