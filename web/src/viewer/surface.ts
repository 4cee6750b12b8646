import type { Triangles } from "../mesh/triangles";
import type { MapName } from "./colour_map";

/** What the viewer is given. It fetches nothing and knows no jobs, so that a report can carry it as it is. */

export type Axis = 0 | 1 | 2;
export const AXES = ["x", "y", "z"] as const;
export type Point = [number, number, number];

export interface Field {
  name: string;
  unit: string;
  /** One per vertex, or one per face; NaN where there is none. */
  values: Float32Array;
  each: "vertex" | "face";
  low: number;
  high: number;
  map: MapName;
}

export interface Surface {
  name: string;
  mesh: Triangles;
  colour: string;
  visible: boolean;
  opacity: number;
  closed: boolean;
  /** Whether it is shown by fewer faces than it has. */
  thinned?: boolean;
  field: Field | null;
}

export interface Clip {
  axis: Axis;
  at: number;
  /** The side that stays: below the plane, or above. */
  keep: "below" | "above";
}

export interface Marker {
  point: Point;
  severity: "error" | "warning" | "info";
}

export interface RegionBox {
  name: string;
  /** Only to be looked at. */
  fixed?: boolean;
  min: Point;
  max: Point;
}

export interface Probe {
  surface: string;
  point: Point;
  value: number | null;
  /** What is filled where the plane cuts it, not the surface. */
  inSection?: boolean;
}
