import type { Triangles } from "./triangles";

/** A surface with one number per triangle; NaN where it has none. */
export interface SolvedSurface {
  mesh: Triangles;
  values: Float32Array;
}

const MAGNITUDE = "magnE";
const TRIANGLE = 2;

/** The binary gmsh 2.2 this server writes for a field: triangles alone, one surface after the other, each with a tag of its own. */
export function readMsh(data: ArrayBuffer): SolvedSurface[] {
  const file = new Sections(data);
  const nodes = file.find("$Nodes");
  const positions = new Float32Array(3 * nodes.count);
  for (let i = 0; i < nodes.count; i++) {
    for (let k = 0; k < 3; k++) positions[3 * i + k] = file.view.getFloat64(nodes.start + 28 * i + 4 + 8 * k, true);
  }
  const { count, start } = file.find("$Elements");
  const [kind, inBlock, tags] = [0, 1, 2].map((k) => file.view.getInt32(start + 4 * k, true));
  if (kind !== TRIANGLE || inBlock !== count || !(tags! > 0))
    throw new Error("The file of the field is not as expected.");
  const number = (face: number, column: number) =>
    file.view.getInt32(start + 12 + 4 * (face * (1 + tags! + 3) + column), true);
  const magnitudes = magnitudesOf(file, count);
  return runsOf(count, (face) => number(face, 1)).map(([first, end]) => ({
    mesh: surfaceOf(positions, first, end - first, (face, k) => number(face, 1 + tags! + k) - 1),
    values: magnitudes.slice(first, end),
  }));
}

/** Where faces of one tag begin and end. */
function runsOf(count: number, tagOf: (face: number) => number): [first: number, end: number][] {
  const runs: [number, number][] = [];
  for (let face = 0; face < count; face++) {
    if (face > 0 && tagOf(face) === tagOf(face - 1)) runs.at(-1)![1] = face + 1;
    else runs.push([face, face + 1]);
  }
  return runs;
}

/** Faces from `first` on with vertices of their own; those of one surface stand together in the file. */
function surfaceOf(
  all: Float32Array,
  first: number,
  count: number,
  corner: (face: number, k: number) => number,
): Triangles {
  const faces = new Uint32Array(3 * count);
  let [low, high] = [all.length, 0];
  for (let f = 0; f < count; f++) {
    for (let k = 0; k < 3; k++) {
      const vertex = corner(first + f, k);
      faces[3 * f + k] = vertex;
      low = Math.min(low, vertex);
      high = Math.max(high, vertex + 1);
    }
  }
  if (low < 0 || 3 * high > all.length) throw new Error("The file of the field names vertices it does not have.");
  for (let i = 0; i < faces.length; i++) faces[i]! -= low;
  return { positions: all.slice(3 * low, 3 * high), faces };
}

function magnitudesOf(file: Sections, total: number): Float32Array {
  const values = new Float32Array(total).fill(Number.NaN);
  const { start } = file.find(`$ElementData\n1\n"${MAGNITUDE}"\n1\n0.0\n3\n0\n1`);
  for (let row = 0; row < total; row++) {
    const face = file.view.getInt32(start + 12 * row, true) - 1;
    values[face] = file.view.getFloat64(start + 12 * row + 4, true);
  }
  return values;
}

/** Where parts of a file begin: a line that names one, a line with a count, then bytes. */
class Sections {
  readonly view: DataView;
  private readonly bytes: Uint8Array;

  constructor(data: ArrayBuffer) {
    this.view = new DataView(data);
    this.bytes = new Uint8Array(data);
  }

  find(head: string): { count: number; start: number } {
    const wanted = new TextEncoder().encode(`${head}\n`);
    for (let at = this.bytes.indexOf(wanted[0]!); at >= 0; at = this.bytes.indexOf(wanted[0]!, at + 1)) {
      if (!wanted.every((byte, i) => this.bytes[at + i] === byte)) continue;
      const line = at + wanted.length;
      const end = this.bytes.indexOf(10, line);
      const count = Number(new TextDecoder("ascii").decode(this.bytes.subarray(line, end)));
      if (end > 0 && Number.isInteger(count)) return { count, start: end + 1 };
    }
    throw new Error(`The file of the field has no ${head.split("\n")[0]}.`);
  }
}
