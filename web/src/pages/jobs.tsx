import { useState } from "preact/hooks";
import { isOver, listJobs } from "../api/jobs";
import type { Job, JobStatus } from "../api/types";
import { Failure } from "../parts/failure";
import { JobWords } from "../parts/job_words";
import { MoreButton } from "../parts/long_list";
import { usePolled } from "../parts/polled";
import { SearchBox, useSettled } from "../parts/search_box";
import { STATUS_WORDS, StatusTag } from "../parts/status_tag";
import { type Column, Table } from "../parts/table";
import { Outcome } from "../parts/verdict";
import { goTo } from "../router";
import { sayOutcome, saySeconds, sayWhen } from "../words";

const LOOK_MS = 2000;
const LOOK_PER_JOB_MS = 4; // a long list is asked for less often
const FIRST = 50;
const WAITED_LONG_MS = 45_000;
const STATUSES: readonly JobStatus[] = ["accepted", "running", "successful", "failed", "dismissed"];
const PROGRESS: readonly Column<Job>[] = [
  {
    title: "Progress",
    cell: (job) =>
      job.status === "running" ? (
        <progress value={job.progress} max={100} aria-label={`Progress of job ${job.jobID}`} />
      ) : (
        <Outcome job={job} />
      ),
  },
  {
    title: "What",
    kind: "prose",
    cell: (job) => `${sayOutcome(job)}${job.queuePosition ? ` (place ${job.queuePosition})` : ""}`,
  },
  { title: "Created", cell: (job) => sayWhen(job.created) },
  {
    title: "Took",
    kind: "number",
    cell: (job) =>
      job.started && isOver(job) && job.finished
        ? saySeconds((Date.parse(job.finished) - Date.parse(job.started)) / 1000)
        : "",
  },
];

/** The jobs of the workspace, newest first; looked at again while this page is open. */
export function JobsPage({ place }: { place: URLSearchParams }) {
  const [status, setStatus] = useState("");
  const search = useSettled("");
  const [label, setLabel] = useState(place.get("label") ?? "");
  const [count, setCount] = useState(FIRST);
  const [picked, setPicked] = useState<string[]>([]);
  const wanted = { status, q: search.settled, label };
  const { value: page, error } = usePolled(
    `${count} ${JSON.stringify(wanted)}`,
    (signal) => listJobs(count, wanted, signal),
    () => Math.max(LOOK_MS, LOOK_PER_JOB_MS * count),
  );
  const found = page?.items ?? [];
  const narrowed = Boolean(search.settled || label || status);
  const waiting = found.filter((job) => job.status === "accepted");
  const running = found.some((job) => job.status === "running");
  const unserved = !running && waiting.some((job) => Date.now() - Date.parse(job.created) > WAITED_LONG_MS);
  const pick = (id: string, on: boolean) =>
    setPicked((before) => (on ? [...before, id].slice(-2) : before.filter((one) => one !== id)));
  return (
    <>
      <div class="heading">
        <h1>Jobs</h1>
        <div class="row">
          <SearchBox label="Search" search={search} />
          {label && (
            <button type="button" class="tag" aria-label={`No longer only ${label}`} onClick={() => setLabel("")}>
              {label} ×
            </button>
          )}
          <label class="row">
            <span class="hidden-label">Status</span>
            <select value={status} onChange={(event) => setStatus(event.currentTarget.value)}>
              <option value="">All</option>
              {STATUSES.map((one) => (
                <option key={one} value={one}>
                  {STATUS_WORDS[one]}
                </option>
              ))}
            </select>
          </label>
          <button
            type="button"
            disabled={picked.length !== 2}
            onClick={() => goTo(`#/compare?a=${picked[0]}&b=${picked[1]}`)}
          >
            Compare two
          </button>
          <a class="button primary" href="#/new">
            New job
          </a>
        </div>
      </div>
      {error ? <Failure error={error} /> : null}
      {unserved && (
        <p class="note warn" role="status">
          Jobs are waiting and nobody works on them: no worker seems to be running. They are kept, and start when one
          comes.
        </p>
      )}
      {!page && !error && <p class="empty">Loading…</p>}
      {page && found.length === 0 && (
        <p class="card empty">{narrowed ? "No job matches the search." : "No jobs yet."}</p>
      )}
      {found.length > 0 && (
        <section class="card" aria-label="All jobs">
          <Table
            rows={found}
            keyOf={(job) => job.jobID}
            columns={[
              {
                title: "Compare",
                silent: true,
                cell: ({ jobID }) => (
                  <input
                    type="checkbox"
                    aria-label={`Compare job ${jobID}`}
                    checked={picked.includes(jobID)}
                    onChange={(event) => pick(jobID, event.currentTarget.checked)}
                  />
                ),
              },
              {
                title: "Process",
                cell: (job) => (
                  <>
                    <a href={`#/jobs/${job.jobID}`}>{job.processID}</a>{" "}
                    <span class="mono muted">{job.jobID.slice(0, 8)}</span>
                    <JobWords job={job} onLabel={setLabel} />
                  </>
                ),
              },
              { title: "Status", cell: (job) => <StatusTag job={job} /> },
              ...PROGRESS,
            ]}
          />
        </section>
      )}
      <MoreButton onMore={page?.next ? () => setCount(4 * count) : null} />
    </>
  );
}
