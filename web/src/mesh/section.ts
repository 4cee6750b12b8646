import type { Triangles } from "./triangles";

/** Where a plane across one axis cuts a surface: ends of segments, two points (x, y, z) each. */
export function sectionOf({ positions: p, faces }: Triangles, axis: 0 | 1 | 2, at: number): Float32Array {
  const ends: number[] = [];
  for (let f = 0; f < faces.length; f += 3) {
    const corners = [3 * faces[f]!, 3 * faces[f + 1]!, 3 * faces[f + 2]!];
    const above =
      (p[corners[0]! + axis]! > at ? 1 : 0) +
      (p[corners[1]! + axis]! > at ? 1 : 0) +
      (p[corners[2]! + axis]! > at ? 1 : 0);
    if (above === 0 || above === 3) continue;
    for (let k = 0; k < 3; k++) {
      const a = corners[k]!;
      const b = corners[(k + 1) % 3]!;
      const [low, high] = [p[a + axis]!, p[b + axis]!];
      if (low > at === high > at) continue;
      const share = (at - low) / (high - low);
      for (let c = 0; c < 3; c++) ends.push(c === axis ? at : p[a + c]! + share * (p[b + c]! - p[a + c]!));
    }
  }
  return Float32Array.from(ends);
}
