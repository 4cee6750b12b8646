import type { Unit } from "./api/types";

export const UNITS: readonly Unit[] = ["mm", "cm", "m", "in"];
export const UNIT_NAMES: Record<Unit, string> = { mm: "millimetres", cm: "centimetres", m: "metres", in: "inches" };
const MM: Record<Unit, number> = { mm: 1, cm: 10, m: 1000, in: 25.4 };
const BODY_MM = [1000, 2300] as const; // tall and flat
const HEAD_MM = [120, 420] as const;
const FLAT = 0.4;
const SMALLEST_PART_MM = 20;
const LARGEST_BODY_MM = 2800;

/** The unit in which these extents (as in the file) would be a person's body or head; null if in none, or in several. */
export function suggestUnit(extents: readonly number[]): Unit | null {
  const longest = Math.max(...extents);
  const [least, most] = Math.min(...extents) < FLAT * longest ? BODY_MM : HEAD_MM;
  const fitting = UNITS.filter((unit) => longest * MM[unit] >= least && longest * MM[unit] <= most);
  return fitting.length === 1 ? fitting[0]! : null;
}

/** Why a body of this longest side (as in the file) cannot be meant in that unit; empty if it can. As core/io/extents.py. */
export function doubtUnit(longest: number, unit: Unit): string {
  const mm = toMm(longest, unit);
  if (!(longest > 0) || (mm >= SMALLEST_PART_MM && mm <= LARGEST_BODY_MM)) return "";
  const better = UNITS.find((one) => longest * MM[one] >= SMALLEST_PART_MM && longest * MM[one] <= LARGEST_BODY_MM);
  const instead = better
    ? ` In ${UNIT_NAMES[better]} it would be ${sayLength(toMm(longest, better))}.`
    : " No unit here makes it the size of a person.";
  return `In ${UNIT_NAMES[unit]} this is ${sayLength(mm)} long, unlike a person or a part of one.${instead}`;
}

export function toMm(length: number, unit: Unit): number {
  return length * MM[unit];
}

/** A length as people say it: 1.67 m, 23.4 cm, 5.2 mm. */
export function sayLength(mm: number): string {
  if (mm >= 1e6) return `${(mm / 1e6).toPrecision(3)} km`;
  if (mm >= 1000) return `${(mm / 1000).toFixed(2)} m`;
  if (mm >= 100) return `${(mm / 10).toFixed(1)} cm`;
  return mm >= 0.001 ? `${mm.toPrecision(3)} mm` : `${mm.toExponential(1)} mm`;
}
