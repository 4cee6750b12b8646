import { getInputs, getJob, getReport } from "../api/jobs";
import type { Job, Report } from "../api/types";
import { Failure } from "../parts/failure";
import { useLoaded } from "../parts/loaded";
import { StatusTag } from "../parts/status_tag";
import { Verdict } from "../parts/verdict";
import { sayNumber } from "../words";

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
      <div class="card scroll-x">
        <table>
          <thead>
            <tr>
              <th>
                <span class="hidden-label">What</span>
              </th>
              {[left, right].map(({ job }) => (
                <th key={job.jobID}>
                  <a href={`#/jobs/${job.jobID}`}>{job.processID}</a> <span class="mono">{job.jobID.slice(0, 8)}</span>{" "}
                  <StatusTag job={job} /> <Verdict verdict={job.verdict} />
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {rowsOf(left, right).map(([what, one, other]) => (
              <tr key={what} class={one === other ? "" : "differs"}>
                <td>{what}</td>
                <td class="mono">{one}</td>
                <td class="mono">{other}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </>
  );
}

function rowsOf(left: Side, right: Side): [string, string, string][] {
  const [a, b] = [linesOf(left), linesOf(right)];
  return [...new Set([...a.keys(), ...b.keys()])].map((what) => [what, a.get(what) ?? "–", b.get(what) ?? "–"]);
}

function linesOf({ job, report, inputs }: Side): Map<string, string> {
  const lines = new Map<string, string>([["Summary", job.summary ?? job.failure?.message ?? job.message]]);
  flatten(inputs, "", lines);
  for (const [name, one] of Object.entries(report?.thickness ?? {})) {
    lines.set(`${name}: on target`, `${(100 * one.on_target_area).toFixed(2)} %`);
    lines.set(`${name}: least depth`, `${sayNumber(one.min_mm)} mm`);
  }
  for (const [name, one] of Object.entries(report?.meshes ?? {})) {
    lines.set(`${name}: faces`, String(one.faces));
    lines.set(`${name}: area`, `${sayNumber(one.area_mm2)} mm²`);
    lines.set(`${name}: lowest q`, sayNumber(one.quality.minimum));
  }
  for (const pair of report?.pairs ?? []) {
    lines.set(`${pair.a} – ${pair.b}: intersecting`, String(pair.intersecting_pairs));
    lines.set(
      `${pair.a} – ${pair.b}: smallest gap`,
      pair.min_gap_mm === null ? "–" : `${sayNumber(pair.min_gap_mm)} mm`,
    );
  }
  for (const [phase, seconds] of Object.entries(job.timings_s ?? {}))
    lines.set(`Time: ${phase}`, `${seconds.toFixed(1)} s`);
  return lines;
}

function flatten(value: unknown, name: string, lines: Map<string, string>): void {
  if (typeof value === "object" && value !== null) {
    for (const [key, one] of Object.entries(value)) flatten(one, name ? `${name}.${key}` : key, lines);
  } else {
    lines.set(name, String(value));
  }
}
