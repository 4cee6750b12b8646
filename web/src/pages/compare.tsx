import { getInputs, getJob, getReport } from "../api/jobs";
import type { Job, Report } from "../api/types";
import { labelOf } from "../form/schema_kind";
import { Failure } from "../parts/failure";
import { useLoaded } from "../parts/loaded";
import { StatusTag } from "../parts/status_tag";
import { Table } from "../parts/table";
import { Outcome } from "../parts/verdict";
import { sayArea, sayCount, sayNumber, sayOutcome, saySeconds, sayShare } from "../words";

const TIME = "Time: "; // always another: nobody looks for that

interface Side {
  job: Job;
  report: Report | null;
  inputs: Record<string, unknown>;
}

async function load(id: string, signal: AbortSignal): Promise<Side> {
  const [job, { inputs }] = await Promise.all([getJob(id, signal), getInputs(id, signal)]);
  const report = await getReport(id, signal).catch(() => null); // a job that waits has none yet
  return { job, report, inputs };
}

/** Two jobs line by line: what differs stands out. */
export function ComparePage({ a, b }: { a: string; b: string }) {
  const sides = useLoaded(`${a} ${b}`, (signal) => Promise.all([load(a, signal), load(b, signal)]));
  if (sides.error) return <Failure error={sides.error} again={sides.again} />;
  if (!sides.value) return <p class="empty">Loading…</p>;
  const [left, right] = sides.value;
  return (
    <>
      <div class="heading">
        <h1>Two jobs compared</h1>
        <a class="button" href="#/jobs">
          Back to the jobs
        </a>
      </div>
      <section class="card" aria-label="Line by line">
        <Table
          rows={rowsOf(left, right)}
          keyOf={([what]) => what}
          rowClass={([what, one, other]) => (one === other || what.startsWith(TIME) ? "" : "differs")}
          columns={[
            { title: "What", silent: true, cell: ([what]) => what },
            { title: <SideTitle side={left} />, kind: "mono", cell: ([, one]) => one },
            { title: <SideTitle side={right} />, kind: "mono", cell: ([, , other]) => other },
          ]}
        />
      </section>
    </>
  );
}

function SideTitle({ side: { job } }: { side: Side }) {
  return (
    <>
      <a href={`#/jobs/${job.jobID}`}>{job.processID}</a> <span class="mono">{job.jobID.slice(0, 8)}</span>{" "}
      <StatusTag job={job} /> <Outcome job={job} />
    </>
  );
}

function rowsOf(left: Side, right: Side): [string, string, string][] {
  const [a, b] = [linesOf(left), linesOf(right)];
  return [...new Set([...a.keys(), ...b.keys()])].map((what) => [what, a.get(what) ?? "–", b.get(what) ?? "–"]);
}

function linesOf({ job, report, inputs }: Side): Map<string, string> {
  const lines = new Map<string, string>([["Summary", sayOutcome(job)]]);
  flatten(inputs, "", lines);
  for (const [name, one] of Object.entries(report?.thickness ?? {})) {
    lines.set(`${name}: on target`, sayShare(one.on_target_area));
    lines.set(`${name}: least depth`, `${sayNumber(one.min_mm)} mm`);
  }
  for (const [name, one] of Object.entries(report?.meshes ?? {})) {
    lines.set(`${name}: faces`, sayCount(one.faces));
    lines.set(`${name}: area`, `${sayArea(one.area_mm2)} cm²`);
    lines.set(`${name}: lowest q`, sayNumber(one.quality.minimum));
  }
  for (const pair of report?.pairs ?? []) {
    lines.set(`${pair.a} – ${pair.b}: intersecting`, sayCount(pair.intersecting_pairs));
    lines.set(
      `${pair.a} – ${pair.b}: smallest gap`,
      pair.min_gap_mm === null ? "–" : `${sayNumber(pair.min_gap_mm)} mm`,
    );
  }
  for (const [phase, seconds] of Object.entries(job.timings_s ?? {})) lines.set(`${TIME}${phase}`, saySeconds(seconds));
  return lines;
}

function flatten(value: unknown, name: string, lines: Map<string, string>): void {
  if (typeof value === "object" && value !== null) {
    for (const [key, one] of Object.entries(value)) {
      const called = Array.isArray(value) ? String(Number(key) + 1) : key === "href" ? "" : labelOf(key);
      flatten(one, [name, called].filter(Boolean).join(" › "), lines);
    }
  } else {
    lines.set(name, String(value));
  }
}
