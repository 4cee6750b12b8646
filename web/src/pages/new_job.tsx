import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { execute, getInputs, listJobs } from "../api/jobs";
import { findEars, listMeshes } from "../api/meshes";
import { askJson, ServerError } from "../api/server";
import type { Process, ProcessSummary } from "../api/types";
import { Field, type FormContext } from "../form/field";
import { PRESETS } from "../form/presets";
import { hrefOf } from "../form/references_input";
import { kindOf, withoutEmpty } from "../form/schema_kind";
import { asLayers, asRegions, type Region } from "../form/values";
import { Failure } from "../parts/failure";
import { useLoaded } from "../parts/loaded";
import { useTriangles } from "../parts/triangles_of";
import { ViewerPane } from "../parts/viewer_pane";
import { goTo } from "../router";
import { tissueColours } from "../tissues";
import type { RegionBox, Surface } from "../viewer/surface";
import type { Viewer } from "../viewer/viewer";

/** Set up a job: the form is made from the process' own description. */
export function NewJobPage({ query }: { query: URLSearchParams }) {
  const catalogue = useLoaded("processes", (signal) =>
    askJson<{ processes: ProcessSummary[] }>("/v1/processes", { signal }),
  );
  const meshes = useLoaded("meshes", listMeshes);
  const jobs = useLoaded("jobs", (signal) =>
    listJobs(new URLSearchParams({ status: "successful", limit: "50" }), signal),
  );
  const [processId, setProcessId] = useState(query.get("process") ?? "shells");
  const [values, setValues] = useState<Record<string, unknown>>({});
  const [preset, setPreset] = useState("");
  const process = useLoaded(`process ${processId}`, (signal) =>
    askJson<Process>(`/v1/processes/${processId}`, { signal }),
  );
  const [sending, setSending] = useState(false);
  const [error, setError] = useState<unknown>(null);
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const [preview, setPreview] = useState<Region[]>([]);
  const inputs = process.value?.inputs;
  const wantedMesh = query.get("mesh");

  // a field may change in the very click that starts the job, before anything was drawn again
  const newest = useRef(values);
  const update = (all: Record<string, unknown>) => {
    newest.current = all;
    setValues(all);
  };
  const set = (name: string, value: unknown) => update({ ...newest.current, [name]: value });
  // the mesh people came with goes into the first input that takes one
  useEffect(() => {
    if (!inputs || !wantedMesh) return;
    const href = `/v1/meshes/${wantedMesh}`;
    const first = Object.entries(inputs).find(([, one]) =>
      ["reference", "references", "volume"].includes(kindOf(one.schema)),
    );
    if (first && values[first[0]] === undefined) {
      set(first[0], kindOf(first[1].schema) === "references" ? [{ href }] : { href });
    }
  }, [inputs, wantedMesh]);

  // the settings of an earlier job, to be changed
  const like = query.get("like");
  useEffect(() => {
    if (!like) return;
    getInputs(like).then((asked) => {
      setProcessId(asked.processID);
      update(asked.inputs);
    }, setError);
  }, [like]);
  const choose = (id: string, given: Record<string, unknown>, title: string) => {
    const kept = Object.fromEntries(Object.entries(values).filter(([, value]) => hrefOf(value)));
    setProcessId(id);
    update({ ...kept, ...given });
    setPreset(title);
    setError(null);
  };

  const shownName = Object.entries(inputs ?? {}).find(([name]) => hrefOf(values[name]))?.[0];
  const shownHref = shownName ? hrefOf(values[shownName]) : "";
  const mesh = meshes.value?.meshes.find((one) => shownHref.endsWith(one.id));
  const triangles = useTriangles(
    shownHref && !shownHref.endsWith("/package") && !mesh?.volume ? { skin: shownHref } : {},
  );
  const shown = triangles.meshes.skin;
  const surfaces = useMemo<Surface[]>(
    () =>
      shown
        ? [
            {
              name: mesh?.name ?? "surface",
              mesh: shown.shown,
              colour: tissueColours(["skin"]).skin!,
              visible: true,
              opacity: 1,
              closed: shown.closed,
              field: null,
            },
          ]
        : [],
    [shown, mesh?.name],
  );
  const boxed = Object.entries(inputs ?? {}).filter(([, one]) =>
    ["regions", "auto_or_regions"].includes(kindOf(one.schema)),
  );
  const boxes = useMemo<(RegionBox & { input: string; at: number })[]>(
    () => [
      ...boxed.flatMap(([input]) =>
        asRegions(values[input]).map((region, at) => ({ name: region.name, ...region.box_mm, input, at })),
      ),
      ...preview.map((region) => ({ name: region.name, ...region.box_mm, input: "", at: 0, fixed: true })),
    ],
    [values, inputs, preview],
  );
  const moveBox = (number: number, box: RegionBox) => {
    const one = boxes[number];
    if (!one?.input) return;
    const { min, max } = box;
    set(
      one.input,
      asRegions(values[one.input]).map((region, at) => (at === one.at ? { ...region, box_mm: { min, max } } : region)),
    );
  };
  const layerInput = Object.entries(inputs ?? {}).find(([, one]) => kindOf(one.schema) === "layers");
  const context: FormContext = {
    meshes: meshes.value?.meshes ?? [],
    jobs: jobs.value?.jobs ?? [],
    layers: layerInput
      ? asLayers(values[layerInput[0]] ?? layerInput[1].schema.default).map((layer) => layer.name)
      : [],
    arrays: mesh?.arrays.map((array) => array.name) ?? [],
    labels: mesh?.volume?.labels.map((one) => one.label) ?? [],
    bounds: shown ? { min: shown.min, max: shown.max } : null,
    findEars: mesh ? () => findEars(mesh.id) : null,
    onLook: (point) => viewer?.flyTo(point),
    onPreview: setPreview,
  };
  const start = async () => {
    setSending(true);
    setError(null);
    try {
      goTo(`#/jobs/${(await execute(processId, withoutEmpty(newest.current))).jobID}`);
    } catch (reason) {
      setError(reason);
      setSending(false);
    }
  };
  const problems = error instanceof ServerError ? (error.problem?.errors ?? []) : [];
  const problemOf = (name: string) =>
    problems
      .filter((one) => one.pointer?.split("/").includes(name))
      .map((one) => one.detail)
      .join(" ");
  return (
    <>
      <div class="heading">
        <h1>New job</h1>
      </div>
      <div class="bench wide-panel">
        <div class="view stack">
          <ViewerPane
            label="3D view of the surface with its boxes"
            surfaces={surfaces}
            boxes={boxes}
            onBox={moveBox}
            onViewer={setViewer}
            loading={
              shownHref && !mesh?.volume && !shown && triangles.loading && !triangles.failure ? "Loading the mesh…" : ""
            }
            failure={triangles.failure}
            empty="Choose a mesh to see it here."
          />
          {boxes.some((box) => !box.fixed) && (
            <p class="muted small">Pull at the round handles to move a side of a box, or type its corners.</p>
          )}
        </div>
        <form
          class="stack"
          onSubmit={(event) => {
            event.preventDefault();
            void start();
          }}
        >
          <section class="card stack" aria-label="Presets">
            <h2>Start from</h2>
            {PRESETS.map((one) => (
              <button
                key={one.title}
                type="button"
                class="preset"
                aria-pressed={preset === one.title}
                onClick={() => choose(one.process, one.values, one.title)}
              >
                <span>
                  <b>{one.title}</b>
                  <br />
                  <span class="small">{one.about}</span>
                </span>
              </button>
            ))}
            <div class="field">
              <label for="process">Process</label>
              <select id="process" value={processId} onChange={(event) => choose(event.currentTarget.value, {}, "")}>
                {catalogue.value?.processes.map((one) => (
                  <option key={one.id} value={one.id}>
                    {one.title}
                  </option>
                ))}
              </select>
              <p class="muted small">{process.value?.description.replaceAll("`", "")}</p>
            </div>
          </section>
          {catalogue.error || process.error ? (
            <Failure error={catalogue.error || process.error} again={process.error ? process.again : catalogue.again} />
          ) : null}
          {meshes.error ? <Failure error={meshes.error} again={meshes.again} /> : null}
          {process.loading && <p class="empty">Loading the form…</p>}
          <section class="card stack" aria-label="Inputs">
            {Object.entries(inputs ?? {}).map(([name, one]) => (
              <Field
                key={`${processId} ${name}`}
                name={name}
                schema={{ ...one.schema, description: one.description || one.schema.description || "" }}
                required={one.minOccurs > 0}
                value={values[name]}
                context={context}
                problem={problemOf(name)}
                onValue={(value) => set(name, value)}
              />
            ))}
          </section>
          {error ? <Failure error={error} /> : null}
          <div class="row end">
            <button type="submit" class="primary" disabled={sending || !process.value}>
              {sending ? "Sending…" : "Start the job"}
            </button>
          </div>
        </form>
      </div>
    </>
  );
}
