import { useState } from "preact/hooks";
import {
  type Cohort,
  cohortJobs,
  cohortResults,
  dismissCohort,
  getCohort,
  removeCohort,
  retryCohort,
} from "../api/cohorts";
import type { Job } from "../api/types";
import { ConfirmedButton } from "../parts/confirmed_button";
import { Failure } from "../parts/failure";
import { usePolled } from "../parts/polled";
import { saveFrom } from "../parts/save";
import { StatusTag } from "../parts/status_tag";
import { type Column, Table } from "../parts/table";
import { Outcome } from "../parts/verdict";
import { goTo } from "../router";
import { sayCount, sayOutcome } from "../words";

const LOOK_MS = 2000;
const FILES = [
  ["table", "Table (CSV)", "summary.csv"],
  ["report_html", "Summary (HTML)", "report.html"],
  ["summary", "Summary (JSON)", "summary.json"],
  ["packages", "All results (zip)", "results.zip"],
] as const;

type Refused = NonNullable<Cohort["refused"]>[number];

const COLUMNS: readonly Column<Job | Refused>[] = [
  {
    title: "Subject",
    cell: (one) => ("jobID" in one ? <a href={`#/jobs/${one.jobID}`}>{one.subject}</a> : one.subject),
  },
  {
    title: "Status",
    cell: (one) => ("jobID" in one ? <StatusTag job={one} /> : <span class="tag bad">refused</span>),
  },
  { title: "Verdict", cell: (one) => ("jobID" in one ? <Outcome job={one} /> : null) },
  {
    title: "What",
    kind: "prose",
    cell: (one) =>
      "jobID" in one ? (
        sayOutcome(one)
      ) : (
        <>
          {one.message} <span class="mono">{one.code}</span>
        </>
      ),
  },
];

/** One cohort: a line per subject, and the summary when all have ended. */
export function CohortPage({ id }: { id: string }) {
  const now = usePolled(
    id,
    async (signal) => ({ cohort: await getCohort(id, signal), jobs: await cohortJobs(id, signal) }),
    ({ cohort }) => (cohort.status === "finished" ? null : LOOK_MS),
  );
  const [refused, setRefused] = useState<unknown>(null);
  const act = async (action: () => Promise<unknown>, then = now.again) => {
    setRefused(null);
    try {
      await action();
      then();
    } catch (reason) {
      setRefused(reason);
    }
  };
  const save = (name: string, fileName: string) =>
    act(async () => {
      const found = (await cohortResults(id))[name];
      if (found) await saveFrom(new URL(found.href).pathname, fileName);
    });
  if (!now.value) return now.error ? <Failure error={now.error} again={now.again} /> : <p class="empty">Loading…</p>;
  const { cohort, jobs } = now.value;
  const live = cohort.counts.accepted + cohort.counts.running;
  const failed = cohort.counts.failed + cohort.counts.dismissed;
  return (
    <>
      <div class="heading">
        <h1>{cohort.name ?? "Cohort"}</h1>
        <div class="row">
          {live === 0 && failed > 0 && (
            <button type="button" onClick={() => act(() => retryCohort(id))}>
              Retry what failed
            </button>
          )}
          {live > 0 ? (
            <button type="button" class="danger" onClick={() => act(() => dismissCohort(id))}>
              Dismiss
            </button>
          ) : (
            <ConfirmedButton
              label="Remove with its results"
              about="Remove the cohort with its results"
              onConfirmed={() =>
                void act(
                  () => removeCohort(id),
                  () => goTo("#/cohorts"),
                )
              }
            />
          )}
        </div>
      </div>
      {now.error ? <Failure error={now.error} again={now.again} /> : null}
      {refused ? <Failure error={refused} /> : null}
      <section class="card stack" aria-label="Progress">
        <p aria-live="polite">
          {cohort.processID}: {sayCount(cohort.ready)} of {sayCount(cohort.subjects)} subjects are ready,{" "}
          {sayCount(live)} wait or run, {sayCount(cohort.counts.failed)} failed, {sayCount(cohort.counts.refused)}{" "}
          refused.
        </p>
        <progress value={cohort.progress} max={100} aria-label="Progress of the cohort" />
        {cohort.status === "finished" && cohort.summaryJob && (
          <div class="row">
            {FILES.map(([name, title, fileName]) => (
              <button key={name} type="button" onClick={() => save(name, fileName)}>
                {title}
              </button>
            ))}
            <a class="button" href={`#/jobs/${cohort.summaryJob}`}>
              Summary job
            </a>
          </div>
        )}
      </section>
      <section class="card" aria-label="Subjects">
        <Table
          rows={[...jobs, ...(cohort.refused ?? [])]}
          keyOf={(one) => ("jobID" in one ? one.jobID : one.subject)}
          columns={COLUMNS}
        />
      </section>
    </>
  );
}
