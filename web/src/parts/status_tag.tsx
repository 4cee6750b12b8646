import type { Job } from "../api/types";

const TONES = { accepted: "", running: "live", successful: "good", failed: "bad", dismissed: "" } as const;
export const STATUS_WORDS = {
  accepted: "waiting",
  running: "running",
  successful: "done",
  failed: "failed",
  dismissed: "dismissed",
} as const;

export function StatusTag({ job }: { job: Job }) {
  return <span class={`tag ${TONES[job.status]}`}>{STATUS_WORDS[job.status]}</span>;
}
