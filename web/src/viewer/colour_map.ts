/** Colour maps by their stops: viridis for amounts (van der Walt and Smith, CC0), a blue-white-red one for signed values. */

export type MapName = "viridis" | "signed";
type Stop = readonly [number, number, number];

const STOPS: Record<MapName, readonly Stop[]> = {
  viridis: [
    [68, 1, 84],
    [71, 39, 119],
    [62, 73, 137],
    [48, 103, 141],
    [37, 130, 142],
    [30, 157, 136],
    [53, 183, 120],
    [109, 206, 88],
    [180, 221, 43],
    [253, 231, 36],
  ],
  signed: [
    [33, 80, 160],
    [110, 160, 210],
    [240, 240, 238],
    [222, 140, 110],
    [165, 30, 40],
  ],
};
export const NO_VALUE: Stop = [128, 128, 128];

/** Red, green, blue 0 to 255 of a share 0 to 1; shares outside take the ends, NaN is grey. */
export function colourAt(map: MapName, share: number): Stop {
  if (!Number.isFinite(share)) return NO_VALUE;
  const stops = STOPS[map];
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [stops[low]!, stops[low + 1]!];
  const t = place - low;
  return [0, 1, 2].map((i) => Math.round(a[i]! + t * (b[i]! - a[i]!))) as unknown as Stop;
}

/** A colour for each vertex, linear bytes ready for the graphics card (it mixes light, not screen values). */
export function coloursOf(values: Float32Array, low: number, high: number, map: MapName): Uint8Array {
  const table = new Uint8Array(3 * 257);
  for (let i = 0; i <= 255; i++) table.set(colourAt(map, i / 255).map(toLinear), 3 * i);
  table.set(NO_VALUE.map(toLinear), 3 * 256);
  const colours = new Uint8Array(3 * values.length);
  const scale = high > low ? 255 / (high - low) : 0;
  for (let v = 0; v < values.length; v++) {
    const value = values[v]!;
    const entry = Number.isFinite(value) ? Math.min(Math.max(Math.round((value - low) * scale), 0), 255) : 256;
    colours[3 * v] = table[3 * entry]!;
    colours[3 * v + 1] = table[3 * entry + 1]!;
    colours[3 * v + 2] = table[3 * entry + 2]!;
  }
  return colours;
}

function toLinear(byte: number): number {
  const share = byte / 255;
  return Math.round(255 * (share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4));
}

/** Where a map starts and ends so that most of the surface is told apart: the 2nd and 98th percentile. */
export function usualRange(values: Float32Array): [number, number] {
  const finite = values.filter((value) => Number.isFinite(value)).sort();
  if (finite.length === 0) return [0, 1];
  const at = (share: number) => finite[Math.round(share * (finite.length - 1))]!;
  const [low, high] = [at(0.02), at(0.98)];
  return high > low ? [low, high] : [low, low + (Math.abs(low) || 1)];
}
