import type { Triangles } from "./triangles";

/** Faces of a mesh by where they lie along one axis, so that a plane across it meets few of them.
 *
 * The extent is cut into slabs of equal height; each lists the faces that reach into it. */
export class Slabs {
  private readonly starts: Uint32Array;
  private readonly listed: Uint32Array;
  private readonly low: number;
  private readonly perMm: number;
  private readonly count: number;

  constructor({ positions: p, faces }: Triangles, axis: 0 | 1 | 2) {
    let low = Number.POSITIVE_INFINITY;
    let high = Number.NEGATIVE_INFINITY;
    for (let i = axis; i < p.length; i += 3) {
      if (p[i]! < low) low = p[i]!;
      if (p[i]! > high) high = p[i]!;
    }
    const number = faces.length / 3;
    this.count = Math.min(Math.max(Math.ceil(Math.sqrt(number)), 1), MOST_SLABS);
    this.low = low;
    this.perMm = high > low ? this.count / (high - low) : 0;
    const firsts = new Uint16Array(number);
    const lasts = new Uint16Array(number);
    const starts = new Uint32Array(this.count + 1);
    for (let f = 0; f < number; f++) {
      const a = p[3 * faces[3 * f]! + axis]!;
      const b = p[3 * faces[3 * f + 1]! + axis]!;
      const c = p[3 * faces[3 * f + 2]! + axis]!;
      const first = this.slabOf(Math.min(a, b, c));
      const last = this.slabOf(Math.max(a, b, c));
      firsts[f] = first;
      lasts[f] = last;
      for (let slab = first; slab <= last; slab++) starts[slab + 1]! += 1;
    }
    for (let slab = 0; slab < this.count; slab++) starts[slab + 1]! += starts[slab]!;
    const next = starts.slice();
    this.listed = new Uint32Array(starts[this.count]!);
    for (let f = 0; f < number; f++) {
      for (let slab = firsts[f]!; slab <= lasts[f]!; slab++) this.listed[next[slab]!++] = f;
    }
    this.starts = starts;
  }

  /** Numbers of all faces that may reach the plane. */
  facesNear(at: number): Uint32Array {
    const slab = this.slabOf(at);
    return this.listed.subarray(this.starts[slab]!, this.starts[slab + 1]!);
  }

  private slabOf(at: number): number {
    return Math.min(Math.max(Math.floor((at - this.low) * this.perMm), 0), this.count - 1);
  }
}

const MOST_SLABS = 1024;
