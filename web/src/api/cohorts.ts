import { listJobs } from "./jobs";
import { sendOnce } from "./once";
import { type Page, upTo } from "./pages";
import { ask, askJson, ServerError, sendJson } from "./server";
import type { Job, JobStatus, ResultReference } from "./types";
import { sendFile } from "./uploads";

export interface Cohort {
  id: string;
  processID: string;
  name?: string;
  labels: string[];
  status: "running" | "summarizing" | "finished";
  progress: number;
  subjects: number;
  counts: Record<JobStatus | "refused", number>;
  ready: number;
  refused?: { subject: string; code: string; message: string }[];
  round: number;
  created: string;
  summaryJob?: string;
}

export interface CohortSettings {
  process: string;
  name?: string;
  labels?: string[];
  inputs: Record<string, unknown>;
}

export function listCohorts(count: number, signal: AbortSignal): Promise<Page<Cohort>> {
  return upTo(count, async (part) => {
    const { cohorts, next } = await askJson<{ cohorts: Cohort[]; next?: string }>(`/v1/cohorts?${part}`, { signal });
    return { items: cohorts, next };
  });
}

export function getCohort(id: string, signal: AbortSignal): Promise<Cohort> {
  return askJson(`/v1/cohorts/${id}`, { signal });
}

/** Of all subjects, in the order of the request. */
export async function cohortJobs(id: string, signal: AbortSignal): Promise<Job[]> {
  const { items } = await listJobs(Number.MAX_SAFE_INTEGER, { cohort: id }, signal);
  return items.reverse();
}

export function createCohort(settings: CohortSettings, meshes: string[]): Promise<Cohort> {
  const subjects = meshes.map((id) => ({ mesh: { href: `/v1/meshes/${id}` } }));
  return sendOnce("/v1/cohorts", { ...settings, subjects });
}

const arrived = new WeakMap<File, string>(); // what came whole but did not become a cohort yet: its upload

/** The zip comes in pieces; refused for its settings, it need not come again. */
export async function createCohortOfArchive(
  settings: CohortSettings,
  archive: File,
  unit: string,
  onProgress: (share: number) => void,
): Promise<Cohort> {
  const upload = arrived.get(archive) ?? (await sendFile(archive, onProgress).done);
  arrived.set(archive, upload);
  try {
    return await sendOnce(`${upload}/cohort`, { ...settings, unit });
  } catch (error) {
    if (error instanceof ServerError && error.code === "upload.not_found") arrived.delete(archive);
    throw error;
  }
}

export function retryCohort(id: string): Promise<Cohort> {
  return sendJson(`/v1/cohorts/${id}/retry`, {});
}

/** Takes back what waits or runs; a cohort that has ended meanwhile stays. */
export async function dismissCohort(id: string): Promise<void> {
  await ask(`/v1/cohorts/${id}?keep_ended=true`, { method: "DELETE" });
}

/** Takes a finished cohort away with its jobs and all they made. */
export async function removeCohort(id: string): Promise<void> {
  await ask(`/v1/cohorts/${id}`, { method: "DELETE" });
}

export function cohortResults(id: string): Promise<Record<string, ResultReference>> {
  return askJson(`/v1/cohorts/${id}/results`);
}
