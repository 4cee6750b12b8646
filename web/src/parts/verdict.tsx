import type { Job, Verdict as Word } from "../api/types";

export function Verdict({ verdict }: { verdict: Word | undefined }) {
  if (!verdict) return null;
  return verdict === "simulation_ready" ? (
    <span class="tag good">✓ ready</span>
  ) : (
    <span class="tag bad">✗ not ready</span>
  );
}

/** The verdict on what a job made; one that failed made nothing to be judged. */
export function Outcome({ job }: { job: Job }) {
  return job.status === "successful" ? <Verdict verdict={job.verdict} /> : null;
}
