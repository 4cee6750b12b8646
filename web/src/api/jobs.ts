import { type Page, upTo } from "./pages";
import { ask, askJson, sendJson } from "./server";
import type { Job, Report, ResultReference } from "./types";

export function execute(
  process: string,
  inputs: Record<string, unknown>,
  words: { name?: string; labels?: string[] } = {},
): Promise<Job> {
  const headers = { "Idempotency-Key": crypto.randomUUID() };
  return sendJson<Job>(`/v1/processes/${process}/execution`, { inputs, ...words }, headers);
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

/** Takes a live job back; removes a finished one with its results. */
export async function dismissJob(id: string): Promise<void> {
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

export function isOver(job: Job): boolean {
  return job.status === "successful" || job.status === "failed" || job.status === "dismissed";
}
