import type { Triangles } from "./triangles";

/** The surfaces a report carries; core/reports/scene/scene.py packs them. */

const VERSION = 2;
const BYTES = 3; // of a number, low byte first, each in a run of its own
const DEPTH_STEPS = 254; // bytes 1 to 255; byte 0 is a vertex without a depth

export interface SceneAbout {
  version: number;
  origin_mm: [number, number, number];
  step_mm: number;
  surfaces: PackedSurface[];
  /** What surfaces are painted by, if it is not their distance to the skin. */
  painted?: Painted;
}

export interface Painted {
  name: string;
  unit: string;
  /** From the start. */
  shown: boolean;
}

interface PackedSurface {
  name: string;
  colour: string;
  vertices: number;
  faces: number;
  of_faces: number;
  closed: boolean;
  /** The largest distance to the skin (or of what it is painted by), if its vertices have one. */
  deepest_mm: number | null;
}

export interface SceneMesh {
  mesh: Triangles;
  /** One per vertex, NaN where there is none. */
  depths: Float32Array | null;
}

/** One mesh for each surface of `about`; `packed` is base64 of what was deflated. */
export async function readScene(about: SceneAbout, packed: string): Promise<SceneMesh[]> {
  if (about.version !== VERSION) throw new Error(`This view knows scenes of version ${VERSION}, not ${about.version}.`);
  const data = await inflated(bytesOf(packed));
  const length = about.surfaces.reduce(
    (sum, { faces, vertices, deepest_mm }) =>
      sum + 3 * BYTES * (faces + vertices) + (deepest_mm === null ? 0 : vertices),
    0,
  );
  if (data.length !== length) throw new Error(`The scene has ${data.length} bytes, not ${length}.`);
  let start = 0;
  const take = (rows: number): Uint32Array => {
    const numbers = columns(data, start, rows);
    start += 3 * BYTES * rows;
    return numbers;
  };
  return about.surfaces.map(({ faces, vertices, deepest_mm }) => {
    const corners = cornersOf(take(faces));
    const mesh = { faces: corners, positions: positionsOf(corners, take(vertices), about) };
    if (deepest_mm === null) return { mesh, depths: null };
    const steps = data.subarray(start, start + vertices);
    start += vertices;
    const depths = Float32Array.from(steps, (step) =>
      step === 0 ? Number.NaN : ((step - 1) / DEPTH_STEPS) * deepest_mm,
    );
    return { mesh, depths };
  });
}

/** Rows of three numbers out of runs of single bytes, column by column. */
function columns(data: Uint8Array, start: number, rows: number): Uint32Array {
  const numbers = new Uint32Array(3 * rows);
  for (let column = 0; column < 3; column++) {
    for (let byte = 0; byte < BYTES; byte++) {
      const run = start + (BYTES * column + byte) * rows;
      for (let row = 0; row < rows; row++) numbers[3 * row + column]! |= data[run + row]! << (8 * byte);
    }
  }
  return numbers;
}

/** From how far each corner lies behind the next new vertex to the number of that vertex. */
function cornersOf(steps: Uint32Array): Uint32Array {
  let following = 0;
  for (let i = 0; i < steps.length; i++) {
    const vertex = following - steps[i]!;
    if (vertex === following) following += 1;
    steps[i] = vertex;
  }
  return steps;
}

/** Each vertex was told by how far it is off the middle of the corners its first face had before it. */
function positionsOf(faces: Uint32Array, off: Uint32Array, { origin_mm, step_mm }: SceneAbout): Float32Array {
  const grid = new Int32Array(off.length);
  let following = 0;
  for (let i = 0; i < faces.length; i++) {
    const vertex = faces[i]!;
    if (vertex !== following) continue;
    following += 1;
    const face = i - (i % 3);
    for (let axis = 0; axis < 3; axis++) {
      let sum = 0;
      let known = 0;
      for (let k = 0; k < 3; k++) {
        const corner = faces[face + k]!;
        if (corner >= vertex) continue;
        sum += grid[3 * corner + axis]!;
        known += 1;
      }
      const before = vertex > 0 ? grid[3 * (vertex - 1) + axis]! : 0;
      const zigzag = off[3 * vertex + axis]!;
      const difference = zigzag & 1 ? -(zigzag + 1) / 2 : zigzag / 2;
      grid[3 * vertex + axis] = difference + (known ? Math.floor(sum / known) : before);
    }
  }
  const positions = new Float32Array(grid.length);
  for (let i = 0; i < grid.length; i++) positions[i] = origin_mm[i % 3]! + step_mm * grid[i]!;
  return positions;
}

function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function inflated(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
