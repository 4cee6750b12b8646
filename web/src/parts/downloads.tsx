import { useState } from "preact/hooks";
import { apiKey } from "../api/server";
import type { Job, ResultReference } from "../api/types";
import { Failure } from "./failure";
import { saveFrom } from "./save";

const INLINE = ["report", "report_html"];

/** Package, report and every file by itself; of a job that failed what its steps left. */
export function Downloads(props: { job: Job; results: Record<string, ResultReference> | null; hasReport: boolean }) {
  const { job, results, hasReport } = props;
  const [busy, setBusy] = useState("");
  const [error, setError] = useState<unknown>(null);
  const path = `/v1/jobs/${job.jobID}`;
  const save = async (name: string, ...how: Parameters<typeof saveFrom>) => {
    setBusy(name);
    setError(null);
    try {
      await saveFrom(...how);
    } catch (reason) {
      setError(reason);
    }
    setBusy("");
  };
  const files = Object.entries(results ?? {}).filter(([name]) => !INLINE.includes(name) && name !== "package");
  const pack = results?.package;
  const surfaces = files.filter(([, file]) => file.type === "model/stl");
  const goOn = (process: string, output: string) =>
    `#/new?process=${process}&from=${encodeURIComponent(`${path}/results/${output}`)}`;
  if (!hasReport && files.length === 0 && !pack) return null;
  return (
    <section class="card stack" aria-label="Downloads">
      <h2>{job.status === "failed" ? "Files that are left" : "Files"}</h2>
      <div class="row">
        {pack && (
          <button
            type="button"
            class="primary"
            disabled={busy !== ""}
            onClick={() => save("package", `${path}/results/package`, pack.title)}
          >
            {busy === "package" ? "Loading…" : "Package (zip)"}
          </button>
        )}
        {hasReport && !apiKey() && (
          <a class="button" href={`${path}/report`} target="_blank" rel="noreferrer">
            Open the report
          </a>
        )}
        {hasReport && (
          <button
            type="button"
            disabled={busy !== ""}
            onClick={() => save("html", `${path}/report`, "report.html", "text/html")}
          >
            Report (HTML)
          </button>
        )}
        {hasReport && (
          <button type="button" disabled={busy !== ""} onClick={() => save("json", `${path}/report`, "report.json")}>
            Report (JSON)
          </button>
        )}
        {files.map(([name, file]) => (
          <button
            key={name}
            type="button"
            disabled={busy !== ""}
            onClick={() => save(name, `${path}/results/${name}`, file.title)}
          >
            {busy === name ? "Loading…" : file.title}
          </button>
        ))}
      </div>
      {surfaces.length > 0 && (
        <div class="row">
          <span class="muted small">Go on with</span>
          {pack && surfaces.length > 1 && (
            <a class="button" href={goOn("decimate", "package")}>
              all of them
            </a>
          )}
          {surfaces.map(([name]) => (
            <a key={name} class="button" href={goOn("shells", name)} aria-label={`New job with ${name}`}>
              {name}
            </a>
          ))}
        </div>
      )}
      {error ? <Failure error={error} /> : null}
    </section>
  );
}
