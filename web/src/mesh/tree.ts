import { BufferAttribute, BufferGeometry } from "three";
import { MeshBVH } from "three-mesh-bvh";
import type { Triangles } from "./triangles";

/** The faces in a tree of boxes; their order stays. */
export function treeOf({ positions, faces }: Triangles): MeshBVH {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(faces, 1));
  return new MeshBVH(geometry, { indirect: true });
}
