import { useState } from "preact/hooks";
import { relabelJob } from "../api/jobs";
import type { Job } from "../api/types";
import { Failure } from "./failure";

/** What people call a job; always text. */
export function JobWords({ job, onLabel }: { job: Job; onLabel?: (label: string) => void }) {
  if (!job.name && !job.subject && job.labels.length === 0) return null;
  return (
    <div class="row small">
      {job.name && <b>{job.name}</b>}
      {job.subject && <a href={`#/cohorts/${job.cohortID}`}>{job.subject}</a>}
      {job.labels.map((label) =>
        onLabel ? (
          <button
            key={label}
            type="button"
            class="tag"
            title="Only jobs with this label"
            onClick={() => onLabel(label)}
          >
            {label}
          </button>
        ) : (
          <a key={label} class="tag" href={`#/jobs?label=${encodeURIComponent(label)}`}>
            {label}
          </a>
        ),
      )}
    </div>
  );
}

/** The same to be changed: labels are separated by commas. */
export function JobWordsForm({ job, onChanged }: { job: Job; onChanged: () => void }) {
  const [name, setName] = useState(job.name ?? "");
  const [labels, setLabels] = useState(job.labels.join(", "));
  const [error, setError] = useState<unknown>(null);
  const save = async () => {
    const listed = labels.split(",").flatMap((label) => label.trim() || []);
    try {
      await relabelJob(job.jobID, name.trim() || null, listed);
      setError(null);
      onChanged();
    } catch (reason) {
      setError(reason);
    }
  };
  return (
    <details class="card">
      <summary>Name and labels</summary>
      <form
        class="stack"
        onSubmit={(event) => {
          event.preventDefault();
          void save();
        }}
      >
        <label class="field">
          Name
          <input value={name} maxLength={200} onInput={(event) => setName(event.currentTarget.value)} />
        </label>
        <label class="field">
          Labels, separated by commas
          <input value={labels} onInput={(event) => setLabels(event.currentTarget.value)} />
        </label>
        {error ? <Failure error={error} /> : null}
        <div class="row end">
          <button type="submit">Save</button>
        </div>
      </form>
    </details>
  );
}
