import type { Triangles } from "../src/mesh/triangles";

/** Solids whose numbers can be counted by hand. */

export function tetrahedron(size: number): Triangles {
  return {
    positions: Float32Array.from([0, 0, 0, size, 0, 0, 0, size, 0, 0, 0, size]),
    faces: Uint32Array.from([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]),
  };
}

/** A sphere of rings between two poles, facing outwards. */
export function sphere(radius: number, rings: number): Triangles {
  const around = 2 * rings;
  const positions: number[] = [0, 0, radius];
  for (let i = 1; i < rings; i++) {
    for (let j = 0; j < around; j++) {
      const [polar, angle] = [(Math.PI * i) / rings, (2 * Math.PI * j) / around];
      positions.push(
        radius * Math.sin(polar) * Math.cos(angle),
        radius * Math.sin(polar) * Math.sin(angle),
        radius * Math.cos(polar),
      );
    }
  }
  positions.push(0, 0, -radius);
  const last = positions.length / 3 - 1;
  const at = (i: number, j: number) => 1 + (i - 1) * around + (j % around);
  const faces: number[] = [];
  for (let j = 0; j < around; j++) {
    faces.push(0, at(1, j), at(1, j + 1), last, at(rings - 1, j + 1), at(rings - 1, j));
    for (let i = 1; i < rings - 1; i++) {
      faces.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return { positions: Float32Array.from(positions), faces: Uint32Array.from(faces) };
}

export function stlOf({ positions, faces }: Triangles): ArrayBuffer {
  const view = new DataView(new ArrayBuffer(84 + (50 * faces.length) / 3));
  view.setUint32(80, faces.length / 3, true);
  for (let f = 0; f < faces.length / 3; f++) {
    for (let k = 0; k < 3; k++) {
      for (let axis = 0; axis < 3; axis++) {
        view.setFloat32(84 + 50 * f + 12 + 12 * k + 4 * axis, positions[3 * faces[3 * f + k]! + axis]!, true);
      }
    }
  }
  return view.buffer;
}
