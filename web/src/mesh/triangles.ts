/** A triangle mesh as the page holds it: float32 coordinates in mm (V x 3) and corners of faces (F x 3). */
export interface Triangles {
  positions: Float32Array;
  faces: Uint32Array;
}

export interface Bounds {
  min: [number, number, number];
  max: [number, number, number];
}

export function boundsOf(positions: Float32Array): Bounds {
  const bounds: Bounds = { min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity] };
  for (let i = 0; i < positions.length; i++) {
    const value = positions[i]!;
    const axis = i % 3;
    if (value < bounds.min[axis]!) bounds.min[axis] = value;
    if (value > bounds.max[axis]!) bounds.max[axis] = value;
  }
  return bounds;
}

/** Of all of them together. */
export function boundsOfAll(meshes: readonly Triangles[]): Bounds {
  const all = meshes.map((mesh) => boundsOf(mesh.positions));
  const end = (side: "min" | "max") =>
    [0, 1, 2].map((axis) => Math[side](...all.map((one) => one[side][axis]!))) as Bounds["min"];
  return { min: end("min"), max: end("max") };
}

/** The enclosed volume in mm³: positive for a closed surface that faces outwards. */
export function volumeOf({ positions: p, faces }: Triangles): number {
  let sum = 0;
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f]!;
    const b = 3 * faces[f + 1]!;
    const c = 3 * faces[f + 2]!;
    sum +=
      p[a]! * (p[b + 1]! * p[c + 2]! - p[b + 2]! * p[c + 1]!) +
      p[a + 1]! * (p[b + 2]! * p[c]! - p[b]! * p[c + 2]!) +
      p[a + 2]! * (p[b]! * p[c + 1]! - p[b + 1]! * p[c]!);
  }
  return sum / 6;
}

/** True if every edge has exactly one face on either side; only then is the inside of a section known. */
export function isClosed({ positions, faces }: Triangles): boolean {
  const count = positions.length / 3;
  const open = new Set<number>();
  for (let f = 0; f < faces.length; f += 3) {
    for (let k = 0; k < 3; k++) {
      const a = faces[f + k]!;
      const b = faces[f + ((k + 1) % 3)]!;
      if (!open.delete(b * count + a)) {
        if (open.has(a * count + b)) return false;
        open.add(a * count + b);
      }
    }
  }
  return open.size === 0;
}
