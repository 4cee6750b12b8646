import { sendOnce } from "./once";
import { type Page, upTo } from "./pages";
import { ask, askJson, sendJson } from "./server";
import type { Job, Report, ResultReference } from "./types";

export function execute(
  process: string,
  inputs: Record<string, unknown>,
  words: { name?: string; labels?: string[] } = {},
): Promise<Job> {
  return sendOnce<Job>(`/v1/processes/${process}/execution`, { inputs, ...words });
}

export function getJob(id: string, signal?: AbortSignal): Promise<Job> {
  return askJson(`/v1/jobs/${id}`, signal ? { signal } : {});
}

/** `wanted`: status, q, label, cohort, processID, as the server takes them; those that are empty do not count. */
export function listJobs(count: number, wanted: Record<string, string>, signal: AbortSignal): Promise<Page<Job>> {
  return upTo(count, async (part) => {
    for (const [key, value] of Object.entries(wanted)) if (value) part.set(key, value);
    const { jobs, next } = await askJson<{ jobs: Job[]; next?: string }>(`/v1/jobs?${part}`, { signal });
    return { items: jobs, next };
  });
}

/** Another name (null: none) and other labels. */
export function relabelJob(id: string, name: string | null, labels: string[]): Promise<Job> {
  return askJson(`/v1/jobs/${id}`, {
    method: "PATCH",
    body: JSON.stringify({ name, labels }),
    headers: { "Content-Type": "application/json" },
  });
}

/** Takes a live job back; one that has ended meanwhile stays, with its results. */
export async function dismissJob(id: string): Promise<void> {
  await ask(`/v1/jobs/${id}?keep_ended=true`, { method: "DELETE" });
}

/** Takes a finished job away with its results. */
export async function removeJob(id: string): Promise<void> {
  await ask(`/v1/jobs/${id}`, { method: "DELETE" });
}

export function retryJob(id: string): Promise<Job> {
  return sendJson<Job>(`/v1/jobs/${id}/retry`, {});
}

export function getReport(id: string, signal?: AbortSignal): Promise<Report> {
  return askJson(`/v1/jobs/${id}/report`, signal ? { signal } : {});
}

export interface JobInputs {
  processID: string;
  inputs: Record<string, unknown>;
}

export function getInputs(id: string, signal?: AbortSignal): Promise<JobInputs> {
  return askJson(`/v1/jobs/${id}/inputs`, signal ? { signal } : {});
}

export function getResults(id: string, signal?: AbortSignal): Promise<Record<string, ResultReference>> {
  return askJson(`/v1/jobs/${id}/results`, signal ? { signal } : {});
}

/** What came of a job that ended: its results, or what it left when it failed. */
export async function getOutputs(job: Job, signal?: AbortSignal): Promise<Record<string, ResultReference>> {
  return job.status === "successful" ? getResults(job.jobID, signal) : outputsLeft(job);
}

/** Name of output -> where it is, of a job that failed. */
export function outputsLeft(job: Job): Record<string, ResultReference> {
  const items = job.links.filter((link) => link.rel === "item");
  return Object.fromEntries(items.map((link) => [link.href.slice(link.href.lastIndexOf("/") + 1), link]));
}

export function isOver(job: Job): boolean {
  return job.status === "successful" || job.status === "failed" || job.status === "dismissed";
}
