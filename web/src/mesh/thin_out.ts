import { boundsOf, type Triangles } from "./triangles";

/** Above this a mesh is shown by a coarser one: the screen has no more pixels, and old graphics cards no more memory. */
export const SHOWN_FACES = 500_000;

/** For display alone: vertices of one cell of a grid become their mean, faces that lose a corner go. */
export function thinOut(mesh: Triangles, wanted = SHOWN_FACES): Triangles {
  let result = mesh;
  let cells = Math.sqrt(wanted) * 0.75; // along the longest side; a surface crosses about cells² of them
  for (let turn = 0; turn < 8 && result.faces.length / 3 > wanted; turn++) {
    result = cluster(mesh, Math.floor(cells));
    cells *= 0.8;
  }
  return result;
}

function cluster({ positions, faces }: Triangles, cells: number): Triangles {
  const { min, max } = boundsOf(positions);
  const step = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / cells || 1;
  const count = positions.length / 3;
  const numbers = new Map<number, number>();
  const cellOf = new Uint32Array(count);
  const sums: number[] = [];
  for (let v = 0; v < count; v++) {
    let code = 0;
    for (let axis = 0; axis < 3; axis++) {
      code = code * (cells + 1) + Math.floor((positions[3 * v + axis]! - min[axis]!) / step);
    }
    let number = numbers.get(code);
    if (number === undefined) {
      number = numbers.size;
      numbers.set(code, number);
      sums.push(0, 0, 0, 0);
    }
    cellOf[v] = number;
    for (let axis = 0; axis < 3; axis++) sums[4 * number + axis]! += positions[3 * v + axis]!;
    sums[4 * number + 3]! += 1;
  }
  const means = new Float32Array(3 * numbers.size);
  for (let n = 0; n < numbers.size; n++) {
    for (let axis = 0; axis < 3; axis++) means[3 * n + axis] = sums[4 * n + axis]! / sums[4 * n + 3]!;
  }
  const kept = new Uint32Array(faces.length);
  let used = 0;
  for (let f = 0; f < faces.length; f += 3) {
    const a = cellOf[faces[f]!]!;
    const b = cellOf[faces[f + 1]!]!;
    const c = cellOf[faces[f + 2]!]!;
    if (a === b || b === c || c === a) continue;
    kept[used++] = a;
    kept[used++] = b;
    kept[used++] = c;
  }
  return { positions: means, faces: kept.slice(0, used) };
}
