import { Vector3 } from "three";
import { treeOf } from "./tree";
import type { Triangles } from "./triangles";

/** One number per vertex of a surface. */

/** Quality q = 2 r_in / r_out of the worst face at each vertex; 1 for an equilateral triangle, 0 for a degenerate one. */
export function qualityField({ positions, faces }: Triangles): Float32Array {
  const lowest = new Float32Array(positions.length / 3).fill(1);
  const side = (i: number, j: number) =>
    Math.hypot(
      positions[3 * i]! - positions[3 * j]!,
      positions[3 * i + 1]! - positions[3 * j + 1]!,
      positions[3 * i + 2]! - positions[3 * j + 2]!,
    );
  for (let f = 0; f < faces.length; f += 3) {
    const [i, j, k] = [faces[f]!, faces[f + 1]!, faces[f + 2]!];
    const [a, b, c] = [side(j, k), side(k, i), side(i, j)];
    const q = a * b * c > 0 ? Math.max(0, ((b + c - a) * (c + a - b) * (a + b - c)) / (a * b * c)) : 0;
    for (const v of [i, j, k]) if (q < lowest[v]!) lowest[v] = q;
  }
  return lowest;
}

/** Mean curvature in 1/mm by the cotangent Laplacian over a third of the area around; positive where the surface bulges outwards. */
export function curvatureField({ positions: p, faces }: Triangles): Float32Array {
  const count = p.length / 3;
  const laplacian = new Float64Array(p.length);
  const normals = new Float64Array(p.length);
  const areas = new Float64Array(count);
  const [u, v, n] = [new Vector3(), new Vector3(), new Vector3()];
  for (let f = 0; f < faces.length; f += 3) {
    const corners = [faces[f]!, faces[f + 1]!, faces[f + 2]!];
    for (let k = 0; k < 3; k++) {
      const [o, i, j] = [corners[k]!, corners[(k + 1) % 3]!, corners[(k + 2) % 3]!];
      u.set(p[3 * i]! - p[3 * o]!, p[3 * i + 1]! - p[3 * o + 1]!, p[3 * i + 2]! - p[3 * o + 2]!);
      v.set(p[3 * j]! - p[3 * o]!, p[3 * j + 1]! - p[3 * o + 1]!, p[3 * j + 2]! - p[3 * o + 2]!);
      n.crossVectors(u, v);
      const twice = n.length();
      if (twice === 0) continue;
      const cotangent = u.dot(v) / twice;
      for (let axis = 0; axis < 3; axis++) {
        const step = cotangent * (p[3 * j + axis]! - p[3 * i + axis]!);
        laplacian[3 * i + axis]! += step;
        laplacian[3 * j + axis]! -= step;
        normals[3 * o + axis]! += n.getComponent(axis);
      }
      areas[o]! += twice / 6;
    }
  }
  const curvature = new Float32Array(count);
  for (let i = 0; i < count; i++) {
    n.set(normals[3 * i]!, normals[3 * i + 1]!, normals[3 * i + 2]!).normalize();
    u.set(laplacian[3 * i]!, laplacian[3 * i + 1]!, laplacian[3 * i + 2]!);
    curvature[i] = areas[i]! > 0 ? -u.dot(n) / (4 * areas[i]!) : 0;
  }
  return curvature;
}

/** Distance in mm from every vertex to the nearest point of another surface. */
export function distanceField({ positions }: Triangles, to: Triangles): Float32Array {
  const tree = treeOf(to);
  const distances = new Float32Array(positions.length / 3);
  const point = new Vector3();
  const target = { point: new Vector3(), distance: 0, faceIndex: 0 };
  for (let i = 0; i < distances.length; i++) {
    point.fromArray(positions, 3 * i);
    distances[i] = tree.closestPointToPoint(point, target)?.distance ?? Number.NaN;
  }
  return distances;
}
