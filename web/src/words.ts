/** Numbers as people read them. */

import type { Job, MeshInfo, VolumeInfo } from "./api/types";

export function sayCount(count: number): string {
  return count.toLocaleString("en");
}

export function sayBytes(bytes: number): string {
  const units = ["B", "kB", "MB", "GB"];
  let size = bytes;
  let unit = 0;
  while (size >= 1000 && unit < units.length - 1) {
    size /= 1000;
    unit += 1;
  }
  return `${unit === 0 ? size : size.toPrecision(3)} ${units[unit]}`;
}

export function saySeconds(seconds: number): string {
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}

export function sayWhen(iso: string): string {
  const date = new Date(iso);
  return date.toLocaleString("en-GB", { dateStyle: "medium", timeStyle: "short" });
}

/** The time of day, here and not in Greenwich. */
export function sayTime(iso: string): string {
  return iso ? new Date(iso).toLocaleTimeString("en-GB") : "";
}

/** 0.050, 1.25, 123.4, 26,836.0; far beyond that 1.23e+8. */
export function sayNumber(value: number): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-3) return value.toExponential(2);
  const digits = size >= 100 ? 1 : size >= 1 ? 2 : 3;
  return value.toLocaleString("en", { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

/** Of an area in mm², in cm². */
export function sayArea(mm2: number): string {
  return sayNumber(mm2 / 100);
}

/** 0.9951 as 99.51 %. */
export function sayShare(share: number): string {
  return `${(100 * share).toFixed(2)} %`;
}

/** What came of a job, or how it goes, in a line. */
export function sayOutcome({ summary, failure, phase, message }: Job): string {
  return plain(summary ?? failure?.message ?? phase ?? message);
}

/** Without the marks that set names of programs apart in the server's messages. */
export function plain(text: string): string {
  return text.replaceAll("`", "");
}

/** False for label volumes, fields and coils: they have no triangles. */
export function isSurface(mesh: MeshInfo): boolean {
  return !mesh.volume && !mesh.field && !mesh.coil;
}

/** What an upload holds: `26,756 faces`, `256 × 256 × 176 voxels, 5 labels`, `12,000 numbers of a field`, `992 dipoles`. */
export function sayContent({ faces, volume, field, coil }: MeshInfo): string {
  if (volume) return sayVoxels(volume);
  if (field) return `${sayCount(field.numbers)} numbers of a field`;
  if (coil)
    return coil.dipoles > 0 ? `${sayCount(coil.dipoles)} dipoles` : `${sayCount(coil.wire_pieces)} pieces of wire`;
  return `${sayCount(faces)} faces`;
}

/** `256 × 256 × 176 voxels, 5 labels`. */
function sayVoxels(volume: VolumeInfo): string {
  const { voxels, labels } = volume;
  return `${voxels.join(" × ")} voxels, ${labels.length} label${labels.length === 1 ? "" : "s"}`;
}
