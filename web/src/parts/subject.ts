import type { MeshInfo, Unit } from "../api/types";

/** One line of a cohort that is being put together: a mesh of the server, a file on its way to it, or a whole archive. */
export interface Subject {
  number: number;
  title: string;
  file?: File;
  /** Of what was received, until it is read as a mesh. */
  upload?: string;
  /** The unit `mesh` was read in. */
  unit?: Unit | undefined;
  mesh?: MeshInfo | undefined;
  share: number;
  error?: unknown;
}

export function isArchive(subject: Subject): boolean {
  return subject.file !== undefined && /\.zip$/i.test(subject.file.name);
}

/** Why the cohort cannot be started yet; empty if it can. Lines with errors are left out, an archive goes alone. */
export function whatIsMissing(subjects: readonly Subject[], unit: Unit | ""): string {
  const usable = subjects.filter((one) => !one.error);
  if (usable.length === 0) return "Add meshes, one per subject.";
  if (usable.some((one) => one.file) && !unit) return "Say the unit of the files.";
  if (usable.some(isArchive)) return usable.length > 1 ? "A zip holds all subjects: it goes alone." : "";
  const waiting = usable.filter((one) => !one.mesh).length;
  return waiting > 0 ? `${waiting} of ${usable.length} are still on their way.` : "";
}
