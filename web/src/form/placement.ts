import type { Point } from "../viewer/surface";

/** Where a coil stands: rows of the 4 x 4 matrix from its coordinates to those of the surfaces, in mm. */
export type Placement = readonly (readonly number[])[];

/** The same as people say it: the coil's origin, its z axis (into the head, in SimNIBS) and its y axis (along the handle). */
export interface Stand {
  position: Point;
  towards: Point;
  handle: Point;
}

export const ORIGIN: Stand = { position: [0, 0, 0], towards: [0, 0, 1], handle: [0, 1, 0] };
const LEAST = 1e-6;
const RIGID = 1e-3; // as the server has it
const NUMBER = /[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?/gi;

/** Null where the directions are none, or the same. The handle is turned square to the other. */
export function placementOf({ position, towards, handle }: Stand): Placement | null {
  const z = unit(towards);
  const y = z && unit(handle.map((value, k) => value - dot(handle, z) * z[k]!) as Point);
  if (!z || !y) return null;
  const x = cross(y, z);
  return [...[0, 1, 2].map((k) => [x[k]!, y[k]!, z[k]!, position[k]!]), [0, 0, 0, 1]];
}

export function standOf(placement: Placement): Stand {
  const column = (k: number) => [0, 1, 2].map((row) => placement[row]![k]!) as Point;
  return { position: column(3), towards: column(2), handle: column(1) };
}

/** Sixteen numbers of a text, or twelve without the last row, however they are set apart; null if there are others. */
export function readPlacement(text: string): Placement | null {
  const numbers = (text.match(NUMBER) ?? []).map(Number);
  if (numbers.length === 12) numbers.push(0, 0, 0, 1);
  if (numbers.length !== 16) return null;
  return [0, 4, 8, 12].map((start) => numbers.slice(start, start + 4));
}

/** A turn and a shift alone: no scale, no mirror. */
export function isRigid(placement: Placement): boolean {
  const [x, y, z] = [0, 1, 2].map((k) => [0, 1, 2].map((row) => placement[row]![k]!) as Point) as [Point, Point, Point];
  const off = [dot(x, x) - 1, dot(y, y) - 1, dot(z, z) - 1, dot(x, y), dot(y, z), dot(z, x)].map(Math.abs);
  return Math.max(...off) <= RIGID && dot(cross(x, y), z) > 0 && placement[3]!.join() === "0,0,0,1";
}

export function placed(placement: Placement, [x, y, z]: Point): Point {
  return [0, 1, 2].map((k) => {
    const row = placement[k]!;
    return row[0]! * x + row[1]! * y + row[2]! * z + row[3]!;
  }) as Point;
}

function dot(a: Point, b: Point): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: Point, b: Point): Point {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(a: Point): Point | null {
  const length = Math.sqrt(dot(a, a));
  return length > LEAST ? (a.map((value) => value / length) as Point) : null;
}
