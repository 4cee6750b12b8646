import type { Slabs } from "./slabs";
import type { Triangles } from "./triangles";

/** Segments as they are found, in memory that is kept from one section to the next. */
export class Segments {
  /** Ends of segments, two points (x, y, z) each; only the first `length` numbers count. */
  ends = new Float32Array(6 * 1024);
  length = 0;

  push(x: number, y: number, z: number): void {
    if (this.length + 3 > this.ends.length) {
      const larger = new Float32Array(2 * this.ends.length);
      larger.set(this.ends);
      this.ends = larger;
    }
    this.ends[this.length++] = x;
    this.ends[this.length++] = y;
    this.ends[this.length++] = z;
  }
}

/** Where a plane across one axis cuts a surface, put into `found` in place of what was there. */
export function cutAcross(mesh: Triangles, slabs: Slabs, axis: 0 | 1 | 2, at: number, found: Segments): void {
  const { positions: p, faces } = mesh;
  found.length = 0;
  for (const face of slabs.facesNear(at)) {
    for (let k = 0; k < 3; k++) {
      const a = 3 * faces[3 * face + k]!;
      const b = 3 * faces[3 * face + ((k + 1) % 3)]!;
      const low = p[a + axis]!;
      const high = p[b + axis]!;
      if (low > at === high > at) continue; // a face that is cut has two such sides
      const share = (at - low) / (high - low);
      found.push(
        axis === 0 ? at : p[a]! + share * (p[b]! - p[a]!),
        axis === 1 ? at : p[a + 1]! + share * (p[b + 1]! - p[a + 1]!),
        axis === 2 ? at : p[a + 2]! + share * (p[b + 2]! - p[a + 2]!),
      );
    }
  }
}
