import type { Triangles } from "./triangles";

/** Corners (3 F x 3) with equal coordinates become one vertex; vertices are numbered as they first appear. */
export function weld(corners: Float32Array): Triangles {
  const count = corners.length / 3;
  const bits = new Uint32Array(corners.buffer, corners.byteOffset, corners.length);
  let capacity = 1;
  while (capacity < 2 * count) capacity *= 2;
  const table = new Int32Array(capacity).fill(-1);
  const positions = new Float32Array(corners.length);
  const kept = new Uint32Array(positions.buffer);
  const faces = new Uint32Array(count);
  let used = 0;
  for (let i = 0; i < count; i++) {
    // -0 and 0 are the same place
    const x = bits[3 * i]! === 0x80000000 ? 0 : bits[3 * i]!;
    const y = bits[3 * i + 1]! === 0x80000000 ? 0 : bits[3 * i + 1]!;
    const z = bits[3 * i + 2]! === 0x80000000 ? 0 : bits[3 * i + 2]!;
    let slot = (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) >>> 0;
    slot = (slot ^ (slot >>> 15)) & (capacity - 1);
    let found = table[slot]!;
    while (found >= 0 && (kept[3 * found] !== x || kept[3 * found + 1] !== y || kept[3 * found + 2] !== z)) {
      slot = (slot + 1) & (capacity - 1);
      found = table[slot]!;
    }
    if (found < 0) {
      found = used++;
      table[slot] = found;
      kept[3 * found] = x;
      kept[3 * found + 1] = y;
      kept[3 * found + 2] = z;
    }
    faces[i] = found;
  }
  return { positions: positions.slice(0, 3 * used), faces };
}
