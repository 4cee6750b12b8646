import type { Job } from "../api/types";

const TONES = { accepted: "", running: "live", successful: "good", failed: "bad", dismissed: "" } as const;
const WORDS = {
  accepted: "waiting",
  running: "running",
  successful: "done",
  failed: "failed",
  dismissed: "dismissed",
} as const;

export function StatusTag({ job }: { job: Job }) {
  return <span class={`tag ${TONES[job.status]}`}>{WORDS[job.status]}</span>;
}
