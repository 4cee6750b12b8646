import { useState } from "preact/hooks";
import { createCohort, createCohortOfArchive, listCohorts } from "../api/cohorts";
import { listMeshes } from "../api/meshes";
import { askJson } from "../api/server";
import type { ProcessSummary } from "../api/types";
import { Failure } from "../parts/failure";
import { useLoaded } from "../parts/loaded";
import { SearchBox, useSettled } from "../parts/search_box";
import { goTo } from "../router";
import { sayWhen } from "../words";

/** Studies of many subjects: those there are, and a new one. */
export function CohortsPage() {
  const list = useLoaded("cohorts", listCohorts);
  return (
    <>
      <div class="heading">
        <h1>Cohorts</h1>
      </div>
      {list.error ? <Failure error={list.error} again={list.again} /> : null}
      {list.loading && !list.value && <p class="empty">Loading…</p>}
      {list.value?.cohorts.length === 0 && (
        <p class="card empty">No cohorts yet. A cohort is one job for many meshes.</p>
      )}
      {(list.value?.cohorts.length ?? 0) > 0 && (
        <div class="card scroll-x">
          <table>
            <thead>
              <tr>
                <th>Cohort</th>
                <th>Process</th>
                <th>Status</th>
                <th class="number">Subjects</th>
                <th class="number">Ready</th>
                <th class="number">Failed</th>
                <th>Created</th>
              </tr>
            </thead>
            <tbody>
              {list.value?.cohorts.map((one) => (
                <tr key={one.id}>
                  <td>
                    <a href={`#/cohorts/${one.id}`}>{one.name ?? one.id.slice(0, 8)}</a>
                  </td>
                  <td>{one.processID}</td>
                  <td>{one.status === "finished" ? "finished" : `${one.status} ${one.progress} %`}</td>
                  <td class="number">{one.subjects}</td>
                  <td class="number">{one.ready}</td>
                  <td class="number">{one.counts.failed + one.counts.refused}</td>
                  <td>{sayWhen(one.created)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
      <NewCohort />
    </>
  );
}

function NewCohort() {
  const catalogue = useLoaded("processes", (signal) =>
    askJson<{ processes: ProcessSummary[] }>("/v1/processes", { signal }),
  );
  const search = useSettled("");
  const meshes = useLoaded(`meshes ${search.settled}`, (signal) => listMeshes(signal, 1000, search.settled));
  const [process, setProcess] = useState("shells");
  const [name, setName] = useState("");
  const [inputs, setInputs] = useState("{}");
  const [picked, setPicked] = useState<string[]>([]);
  const [archive, setArchive] = useState<File | null>(null);
  const [unit, setUnit] = useState("mm");
  const [sending, setSending] = useState(false);
  const [error, setError] = useState<unknown>(null);
  const start = async () => {
    setSending(true);
    setError(null);
    try {
      const settings = { process, inputs: JSON.parse(inputs), ...(name.trim() ? { name: name.trim() } : {}) };
      const made = archive
        ? await createCohortOfArchive(settings, archive, unit)
        : await createCohort(settings, picked);
      goTo(`#/cohorts/${made.id}`);
    } catch (reason) {
      setError(reason);
    }
    setSending(false);
  };
  const pick = (id: string, on: boolean) => setPicked(on ? [...picked, id] : picked.filter((one) => one !== id));
  return (
    <form
      class="card stack"
      aria-label="New cohort"
      onSubmit={(event) => {
        event.preventDefault();
        void start();
      }}
    >
      <h2>New cohort</h2>
      <div class="field">
        <label for="cohort-name">Name</label>
        <input id="cohort-name" value={name} maxLength={200} onInput={(event) => setName(event.currentTarget.value)} />
      </div>
      <div class="field">
        <label for="cohort-process">Process</label>
        <select id="cohort-process" value={process} onChange={(event) => setProcess(event.currentTarget.value)}>
          {catalogue.value?.processes.map((one) => (
            <option key={one.id} value={one.id}>
              {one.title}
            </option>
          ))}
        </select>
      </div>
      <div class="field">
        <label for="cohort-inputs">Inputs of all subjects but their meshes, as JSON</label>
        <textarea
          id="cohort-inputs"
          class="mono"
          rows={3}
          value={inputs}
          onInput={(event) => setInputs(event.currentTarget.value)}
        />
      </div>
      <div class="field">
        <label for="cohort-archive">A zip of meshes, one per subject</label>
        <input
          id="cohort-archive"
          type="file"
          accept=".zip,application/zip"
          onChange={(event) => setArchive(event.currentTarget.files?.[0] ?? null)}
        />
      </div>
      {archive ? (
        <div class="field">
          <label for="cohort-unit">Unit of the coordinates in the files</label>
          <select id="cohort-unit" value={unit} onChange={(event) => setUnit(event.currentTarget.value)}>
            {["mm", "cm", "m", "in"].map((one) => (
              <option key={one}>{one}</option>
            ))}
          </select>
        </div>
      ) : (
        <fieldset class="stack">
          <legend>Or meshes of the server ({picked.length} chosen)</legend>
          <SearchBox label="Search meshes" search={search} />
          {meshes.value?.meshes.map((mesh) => (
            <label key={mesh.id} class="row">
              <input
                type="checkbox"
                checked={picked.includes(mesh.id)}
                onChange={(event) => pick(mesh.id, event.currentTarget.checked)}
              />
              <span>{mesh.name}</span>
            </label>
          ))}
        </fieldset>
      )}
      {error ? <Failure error={error} /> : null}
      <div class="row end">
        <button type="submit" class="primary" disabled={sending || (!archive && picked.length === 0)}>
          {sending ? "Sending…" : "Start the cohort"}
        </button>
      </div>
    </form>
  );
}
