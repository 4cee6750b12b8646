import { useRef, useState } from "preact/hooks";
import { createCohort, createCohortOfArchive } from "../api/cohorts";
import { listJobs } from "../api/jobs";
import { listMeshes } from "../api/meshes";
import { askJson } from "../api/server";
import type { Process, Unit } from "../api/types";
import { ProcessInputs } from "../form/process_inputs";
import { kindOf, withoutEmpty } from "../form/schema_kind";
import { asLayers } from "../form/values";
import { goTo } from "../router";
import { UNIT_NAMES, UNITS } from "../units";
import { sayCount } from "../words";
import { DropZone } from "./drop_zone";
import { Failure } from "./failure";
import { useLoaded } from "./loaded";
import { MoreButton, useLongList } from "./long_list";
import { ProcessChoice } from "./process_choice";
import { SearchBox, useSettled } from "./search_box";
import { useSubjects } from "./sent_subjects";
import { isArchive, whatIsMissing } from "./subject";
import { SubjectsTable } from "./subjects_table";
import { NO_WORDS, sentWords, WordsInputs } from "./words_inputs";

const FIRST = 50;
const SUBJECT_INPUTS = ["skin", "mesh", "meshes", "surface", "volume", "base"]; // the server's own order

/** One process on many subjects: who they are, what is done to each of them, and how it is called. */
export function NewCohort() {
  const [processId, setProcessId] = useState("shells");
  const [preset, setPreset] = useState("");
  const [values, setValues] = useState<Record<string, unknown>>({});
  const newest = useRef(values);
  const [words, setWords] = useState(NO_WORDS);
  const [unit, setUnit] = useState<Unit | "">("");
  const { subjects, addFiles, addMesh, remove } = useSubjects(unit);
  const [sending, setSending] = useState(false);
  const [arrived, setArrived] = useState(0); // share of the archive
  const [error, setError] = useState<unknown>(null);
  const process = useLoaded(`process ${processId}`, (signal) =>
    askJson<Process>(`/v1/processes/${processId}`, { signal }),
  );
  const jobs = useLoaded("packages", (signal) => listJobs(FIRST, { status: "successful" }, signal));
  const inputs = process.value?.inputs ?? {};
  const subjectInput = SUBJECT_INPUTS.find((name) => name in inputs);
  // with a mesh per subject the other ways to give surfaces fall away
  const without = subjectInput ? [subjectInput, ...(subjectInput === "mesh" ? ["meshes", "package"] : [])] : [];
  const layerInput = Object.entries(inputs).find(([, one]) => kindOf(one.schema) === "layers");
  const layers = layerInput
    ? asLayers(values[layerInput[0]] ?? layerInput[1].schema.default).map((layer) => layer.name)
    : [];
  const update = (all: Record<string, unknown>) => {
    newest.current = all;
    setValues(all);
  };
  const usable = subjects.filter((one) => !one.error);
  const missing = whatIsMissing(subjects, unit);
  const start = async () => {
    setSending(true);
    setArrived(0);
    setError(null);
    try {
      const settings = { process: processId, inputs: withoutEmpty(newest.current), ...sentWords(words) };
      const archive = usable.find(isArchive)?.file;
      const made = archive
        ? await createCohortOfArchive(settings, archive, unit, setArrived)
        : await createCohort(
            settings,
            usable.map((one) => one.mesh!.id),
          );
      goTo(`#/cohorts/${made.id}`);
    } catch (reason) {
      setError(reason);
    }
    setSending(false);
  };
  return (
    <form
      class="stack"
      aria-label="New cohort"
      onSubmit={(event) => {
        event.preventDefault();
        void start();
      }}
    >
      <section class="card stack" aria-label="Subjects">
        <h2>New cohort</h2>
        <DropZone onFiles={addFiles} small archives />
        {subjects.some((one) => one.file) && (
          <div class="field">
            <label for="cohort-unit">Unit of the coordinates in the files</label>
            <select id="cohort-unit" value={unit} onChange={(event) => setUnit(event.currentTarget.value as Unit | "")}>
              <option value="">Choose…</option>
              {UNITS.map((one) => (
                <option key={one} value={one}>
                  {UNIT_NAMES[one]}
                </option>
              ))}
            </select>
          </div>
        )}
        <SubjectsTable subjects={subjects} onRemove={remove} />
        <HeldMeshes
          chosen={subjects.flatMap((one) => one.mesh?.id ?? [])}
          onAdd={addMesh}
          onRemove={(id) => {
            const one = subjects.find((subject) => subject.mesh?.id === id);
            if (one) remove(one.number);
          }}
        />
      </section>
      <ProcessChoice
        processId={processId}
        description={process.value?.description ?? ""}
        preset={preset}
        onChoose={(id, given, title) => {
          setProcessId(id);
          setPreset(title);
          update(given);
          setError(null);
        }}
      />
      {process.error ? <Failure error={process.error} again={process.again} /> : null}
      {process.value && (
        <ProcessInputs
          key={processId}
          inputs={inputs}
          values={values}
          without={without}
          context={{
            meshes: subjects.flatMap((one) => one.mesh ?? []),
            jobs: jobs.value?.items ?? [],
            layers,
            surfaces: ["skin", ...layers],
            arrays: [],
            labels: [...new Set(subjects.flatMap((one) => one.mesh?.volume?.labels.map((label) => label.label) ?? []))],
            bounds: null,
            findEars: null,
            onLook: () => {},
            onPreview: () => {},
          }}
          error={error}
          onValues={(some) => update({ ...newest.current, ...some })}
        />
      )}
      <section class="card stack" aria-label="What to find it by">
        <WordsInputs words={words} onWords={setWords} />
      </section>
      {error ? <Failure error={error} /> : null}
      <div class="row end">
        <span class="muted small" aria-live="polite">
          {missing || `${isArchive(usable[0]!) ? "All subjects of the zip" : `${sayCount(usable.length)} subjects`}.`}
        </span>
        <button type="submit" class="primary" disabled={sending || missing !== "" || !process.value}>
          {sending ? sayProgress(arrived) : "Start the cohort"}
        </button>
      </div>
    </form>
  );
}

function sayProgress(arrived: number): string {
  return arrived === 0 ? "Sending…" : arrived < 1 ? `Sending, ${Math.floor(100 * arrived)} %` : "Reading…";
}

/** Meshes and volumes the server holds already, to be taken in. */
function HeldMeshes(props: {
  chosen: readonly string[];
  onAdd: (mesh: Parameters<ReturnType<typeof useSubjects>["addMesh"]>[0]) => void;
  onRemove: (id: string) => void;
}) {
  const search = useSettled("");
  const meshes = useLongList(
    `meshes ${search.settled}`,
    (count, signal) => listMeshes(count, search.settled, signal),
    FIRST,
  );
  if (meshes.known && meshes.items.length === 0 && !search.typed) return null;
  return (
    <details open={props.chosen.length > 0}>
      <summary>Meshes of the server</summary>
      <div class="stack">
        {meshes.error ? <Failure error={meshes.error} again={meshes.again} /> : null}
        <SearchBox label="Search meshes" search={search} />
        <fieldset class="choices">
          <legend class="hidden-label">Meshes of the server</legend>
          {meshes.items.map((mesh) => (
            <label key={mesh.id} class="row">
              <input
                type="checkbox"
                checked={props.chosen.includes(mesh.id)}
                onChange={(event) => (event.currentTarget.checked ? props.onAdd(mesh) : props.onRemove(mesh.id))}
              />
              <span>{mesh.name}</span>
            </label>
          ))}
        </fieldset>
        <MoreButton onMore={meshes.showMore} loading={meshes.loading} />
      </div>
    </details>
  );
}
