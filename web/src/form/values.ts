/** What the hand-made controls work on, as the server takes it. */

export interface Layer {
  name: string;
  depth_mm?: number | undefined;
  depth_array?: string | undefined;
  side?: "inside" | "outside" | undefined;
}

export interface Region {
  name: string;
  box_mm: { min: [number, number, number]; max: [number, number, number] };
  [more: string]: unknown;
}

/** An inner surface; `inside` and the conductivity may be left to the server. */
export interface Tissue {
  name: string;
  mesh: { href: string };
  inside?: string | undefined;
  conductivity_s_per_m?: number | undefined;
}

export const LARGEST_DEPTH_MM = 100;

export interface Reference {
  href: string;
}

/** A value of the form if it has the shape it should have, else what is taken for granted. */
export function asLayers(value: unknown): Layer[] {
  return Array.isArray(value) ? (value as Layer[]) : [];
}

export function asTissues(value: unknown): Tissue[] {
  return Array.isArray(value) ? (value as Tissue[]) : [];
}

export function asRegions(value: unknown): Region[] {
  return Array.isArray(value) ? (value as Region[]) : [];
}

/** By name: depths of layers, priorities of tissues. */
export function asNumbers(value: unknown): Record<string, number> {
  return typeof value === "object" && value !== null ? (value as Record<string, number>) : {};
}

/** A name nobody has: `region`, `region_2`, ... */
export function freshName(wanted: string, taken: readonly string[]): string {
  let name = wanted;
  for (let number = 2; taken.includes(name); number++) name = `${wanted}_${number}`;
  return name;
}
