import { ask, askJson, sendJson } from "./server";
import type { Job, Report, ResultReference } from "./types";

export interface JobPage {
  jobs: Job[];
  next?: string;
}

export function execute(process: string, inputs: Record<string, unknown>): Promise<Job> {
  return sendJson<Job>(`/v1/processes/${process}/execution`, { inputs }, { "Idempotency-Key": crypto.randomUUID() });
}

export function getJob(id: string, signal?: AbortSignal): Promise<Job> {
  return askJson(`/v1/jobs/${id}`, signal ? { signal } : {});
}

export function listJobs(query: URLSearchParams, signal?: AbortSignal): Promise<JobPage> {
  return askJson(`/v1/jobs?${query}`, signal ? { signal } : {});
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
