import { useEffect, useState } from "preact/hooks";
import { followJob } from "../api/events";
import { execute, getJob, getReport } from "../api/jobs";
import type { Finding, MeshInfo, Report } from "../api/types";
import type { Point } from "../viewer/surface";
import { Failure } from "./failure";
import { Findings } from "./findings";
import { Verdict } from "./verdict";

const found = new Map<string, Report>(); // of this visit, by mesh

/** `validate` on one mesh, right where it is looked at. */
export function QuickCheck({
  mesh,
  atOnce,
  onPlace,
}: {
  mesh: MeshInfo;
  /** Without being asked: of what was just sent. */
  atOnce: boolean;
  onPlace: (point: Point, finding: Finding) => void;
}) {
  const [report, setReport] = useState<Report | null>(found.get(mesh.id) ?? null);
  const [phase, setPhase] = useState("");
  const [error, setError] = useState<unknown>(null);
  const [asked, setAsked] = useState(atOnce && !found.has(mesh.id));
  useEffect(() => setReport(found.get(mesh.id) ?? null), [mesh.id]);
  useEffect(() => {
    if (!asked) return;
    const aborter = new AbortController();
    setPhase("waits for a worker");
    setError(null);
    void (async () => {
      try {
        const job = await execute(
          "validate",
          { meshes: { href: `/v1/meshes/${mesh.id}` } },
          { name: `Quick check of ${mesh.name}` },
        );
        await followJob(
          job.jobID,
          (event) => setPhase(String(event.data.phase || event.data.message || "")),
          () => {},
          aborter.signal,
        );
        const { failure } = await getJob(job.jobID, aborter.signal);
        if (failure) throw new Error(`${failure.message} (${failure.code})`);
        const answer = await getReport(job.jobID, aborter.signal);
        found.set(mesh.id, answer);
        setReport(answer);
      } catch (reason) {
        if (!aborter.signal.aborted) setError(reason);
      } finally {
        setAsked(false);
      }
    })();
    return () => aborter.abort();
  }, [asked, mesh.id]);
  if (report) {
    return (
      <section class="stack" aria-label="Quick check">
        <div class="row">
          <Verdict verdict={report.verdict} /> <span class="small">{report.summary}</span>
        </div>
        {report.verdict !== "simulation_ready" && (
          <div class="row">
            <a class="button" href={`#/new?mesh=${mesh.id}&process=heal`}>
              Heal it…
            </a>
          </div>
        )}
        {report.findings.length > 0 && <Findings findings={report.findings} onPlace={onPlace} />}
      </section>
    );
  }
  return (
    <div class="stack">
      {error ? <Failure error={error} /> : null}
      <div class="row">
        <button type="button" disabled={asked} onClick={() => setAsked(true)}>
          Quick check
        </button>
        <span class="muted small" aria-live="polite">
          {asked ? phase : "Closed, manifold, outward, free of self-intersection?"}
        </span>
      </div>
    </div>
  );
}
