import { isOver } from "../api/jobs";
import type { Job } from "../api/types";
import { Failure } from "../parts/failure";
import { JobActions } from "../parts/job_actions";
import { JobWords, JobWordsForm } from "../parts/job_words";
import { type LogLine, useLiveJob } from "../parts/live_job";
import { ResultView } from "../parts/result_view";
import { StatusTag } from "../parts/status_tag";
import { Outcome } from "../parts/verdict";
import { goTo } from "../router";
import { plain, saySeconds, sayTime, sayWhen } from "../words";

/** One job: how it goes, and what came of it. */
export function JobPage({ id }: { id: string }) {
  const { job, error, log, connected, again } = useLiveJob(id);
  if (!job) return error ? <Failure error={error} again={again} /> : <p class="empty">Loading…</p>;
  return (
    <>
      {error ? <Failure error={error} again={again} /> : null}
      <div class="heading">
        <div class="row">
          <h1>{job.processID}</h1>
          <StatusTag job={job} />
          <Outcome job={job} />
          <JobWords job={job} />
          <span class="mono muted">{job.jobID}</span>
        </div>
        <JobActions job={job} onChanged={again} onGone={() => goTo("#/jobs")} />
      </div>
      {!connected && !isOver(job) && (
        <p class="note warn" role="status">
          The connection is lost. The job goes on; this page follows again when the server is back.
        </p>
      )}
      {!isOver(job) && <Progress job={job} />}
      {job.failure && (
        <div class="note bad stack above" role="alert">
          <p>
            {plain(job.failure.message)} <span class="mono">{job.failure.code}</span>
          </p>
          <p class="small">{WHOSE[job.failure.class]}</p>
        </div>
      )}
      <div class="stack">
        {isOver(job) && job.status !== "dismissed" ? <ResultView job={job} /> : null}
        <JobWordsForm job={job} onChanged={again} />
        <Log log={log} job={job} />
      </div>
    </>
  );
}

const WHOSE = {
  input: "The mesh or the parameters have to change; the same job would fail again.",
  limit: "A limit of this server was reached: make it smaller, or ask an operator.",
  state: "Something the job needed was not there.",
  internal: "The server is at fault. A retry may help.",
};

function Progress({ job }: { job: Job }) {
  return (
    <section class="card stack above" aria-label="Progress">
      <div class="row spread">
        <b>{job.status === "accepted" ? "Waits for a worker" : (job.phase ?? "Starts")}</b>
        <span>
          {job.status === "accepted" && job.queuePosition ? `place ${job.queuePosition} in line` : `${job.progress} %`}
        </span>
      </div>
      <progress value={job.progress} max={100} aria-label="Progress of the job" />
      <p class="muted small" aria-live="polite">
        {job.message}
      </p>
    </section>
  );
}

function Log({ log, job }: { log: readonly LogLine[]; job: Job }) {
  return (
    <details class="card log" open={!isOver(job)}>
      <summary>
        Log and times <span class="muted small">{sayWhen(job.created)}</span>
      </summary>
      {job.timings_s && (
        <table>
          <tbody>
            {Object.entries(job.timings_s).map(([phase, seconds]) => (
              <tr key={phase}>
                <td>{phase}</td>
                <td class="number">{saySeconds(seconds)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {log.length > 0 && (
        // biome-ignore lint/a11y/noNoninteractiveTabindex: a region that scrolls must be reachable by keyboard
        <pre tabIndex={0}>{log.map((line) => `${sayTime(line.at)}  ${line.text}`).join("\n")}</pre>
      )}
    </details>
  );
}
