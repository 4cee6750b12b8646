import { useState } from "preact/hooks";
import { relabelJob } from "../api/jobs";
import type { Job } from "../api/types";
import { Failure } from "./failure";
import { listLabels, type TypedWords, WordsInputs } from "./words_inputs";

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
  const [words, setWords] = useState<TypedWords>({ name: job.name ?? "", labels: job.labels.join(", ") });
  const [error, setError] = useState<unknown>(null);
  const save = async () => {
    try {
      await relabelJob(job.jobID, words.name.trim() || null, listLabels(words.labels));
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
        <WordsInputs words={words} onWords={setWords} />
        {error ? <Failure error={error} /> : null}
        <div class="row end">
          <button type="submit">Save</button>
        </div>
      </form>
    </details>
  );
}
