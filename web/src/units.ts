import type { Unit } from "./api/types";

export const UNITS: readonly Unit[] = ["mm", "cm", "m", "in"];
export const UNIT_NAMES: Record<Unit, string> = { mm: "millimetres", cm: "centimetres", m: "metres", in: "inches" };
const MM: Record<Unit, number> = { mm: 1, cm: 10, m: 1000, in: 25.4 };
const BODY_MM = [1000, 2300] as const; // tall and flat
const HEAD_MM = [120, 420] as const;
const FLAT = 0.4;

/** The unit in which these extents (as in the file) would be a person's body or head; null if in none, or in several. */
export function suggestUnit(extents: readonly number[]): Unit | null {
  const longest = Math.max(...extents);
  const [least, most] = Math.min(...extents) < FLAT * longest ? BODY_MM : HEAD_MM;
  const fitting = UNITS.filter((unit) => longest * MM[unit] >= least && longest * MM[unit] <= most);
  return fitting.length === 1 ? fitting[0]! : null;
}

export function toMm(length: number, unit: Unit): number {
  return length * MM[unit];
}

/** A length as people say it: 1.67 m, 23.4 cm, 5.2 mm. */
export function sayLength(mm: number): string {
  if (mm >= 1000) return `${(mm / 1000).toFixed(2)} m`;
  if (mm >= 100) return `${(mm / 10).toFixed(1)} cm`;
  return `${mm.toPrecision(3)} mm`;
}
