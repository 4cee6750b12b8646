import { useState } from "preact/hooks";
import { dismissJob, isOver, removeJob, retryJob } from "../api/jobs";
import type { Job } from "../api/types";
import { ConfirmedButton } from "./confirmed_button";
import { Failure } from "./failure";

/** Dismiss, retry, remove. */
export function JobActions({ job, onChanged, onGone }: { job: Job; onChanged: () => void; onGone: () => void }) {
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<unknown>(null);
  const act = async (action: () => Promise<unknown>, then: () => void) => {
    setBusy(true);
    setError(null);
    try {
      await action();
      then();
    } catch (reason) {
      setError(reason);
    }
    setBusy(false);
  };
  return (
    <>
      <div class="row">
        <a class="button" href={`#/new?process=${job.processID}&like=${job.jobID}`}>
          Same settings again…
        </a>
        {!isOver(job) && (
          <button
            type="button"
            class="danger"
            disabled={busy}
            onClick={() => act(() => dismissJob(job.jobID), onChanged)}
          >
            Dismiss
          </button>
        )}
        {(job.status === "failed" || job.status === "dismissed") && (
          <button type="button" disabled={busy} onClick={() => act(() => retryJob(job.jobID), onChanged)}>
            Retry
          </button>
        )}
        {isOver(job) && (
          <ConfirmedButton
            label="Remove with its results"
            about="Remove with its results"
            disabled={busy}
            onConfirmed={() => void act(() => removeJob(job.jobID), onGone)}
          />
        )}
      </div>
      {error ? <Failure error={error} /> : null}
    </>
  );
}
