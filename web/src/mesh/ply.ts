import type { Triangles } from "./triangles";

/** The binary PLY this server writes: x, y, z of every vertex, then triangles. A third of the bytes of an STL, already welded. */
export function readPly(data: ArrayBuffer): Triangles {
  const head = new TextDecoder("ascii").decode(data.slice(0, 4096));
  const end = head.indexOf("end_header\n");
  const vertices = Number(/element vertex (\d+)/.exec(head)?.[1]);
  const faces = Number(/element face (\d+)/.exec(head)?.[1]);
  const kind = /property (double|float) x/.exec(head)?.[1];
  if (end < 0 || !head.startsWith("ply\nformat binary_little_endian 1.0") || !kind)
    throw new Error("This is no PLY file of ours.");
  const size = kind === "double" ? 8 : 4;
  const start = end + "end_header\n".length;
  if (data.byteLength < start + 3 * size * vertices + 13 * faces) throw new Error("The PLY file is cut off.");
  const view = new DataView(data);
  const positions = new Float32Array(3 * vertices);
  for (let i = 0; i < 3 * vertices; i++) {
    positions[i] = size === 8 ? view.getFloat64(start + 8 * i, true) : view.getFloat32(start + 4 * i, true);
  }
  const corners = new Uint32Array(3 * faces);
  const first = start + 3 * size * vertices;
  for (let f = 0; f < faces; f++) {
    for (let k = 0; k < 3; k++) corners[3 * f + k] = view.getUint32(first + 13 * f + 1 + 4 * k, true);
  }
  return { positions, faces: corners };
}
