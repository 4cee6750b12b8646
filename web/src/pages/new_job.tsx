import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { execute, getInputs, listJobs } from "../api/jobs";
import { findEars, listMeshes } from "../api/meshes";
import { askJson } from "../api/server";
import type { Process } from "../api/types";
import { findBoxes, withRegion } from "../form/boxes";
import type { FormContext } from "../form/field";
import { ProcessInputs } from "../form/process_inputs";
import { hrefOf } from "../form/references_input";
import { kindOf, withoutEmpty } from "../form/schema_kind";
import { asLayers, asTissues, type Region } from "../form/values";
import { makeTree } from "../mesh/workshop";
import { useDrawnCoil } from "../parts/drawn_coil";
import { Failure } from "../parts/failure";
import { useInputSurfaces } from "../parts/input_surfaces";
import { useLoaded } from "../parts/loaded";
import { MoreButton, useLongList } from "../parts/long_list";
import { ProcessChoice } from "../parts/process_choice";
import { SearchBox, useSettled } from "../parts/search_box";
import { ViewerPane } from "../parts/viewer_pane";
import { NO_WORDS, sentWords, WordsInputs } from "../parts/words_inputs";
import { goTo } from "../router";
import type { RegionBox } from "../viewer/surface";
import type { Viewer } from "../viewer/viewer";

const FIRST_MESHES = 100;
const FIRST_JOBS = 50;

/** Set up a job: the form is made from the process' own description. */
export function NewJobPage({ query }: { query: URLSearchParams }) {
  const search = useSettled("");
  const meshes = useLongList(
    `meshes ${search.settled}`,
    (count, signal) => listMeshes(count, search.settled, signal),
    FIRST_MESHES,
  );
  const jobs = useLongList("jobs", (count, signal) => listJobs(count, { status: "successful" }, signal), FIRST_JOBS);
  const [processId, setProcessId] = useState(query.get("process") ?? "shells");
  const [values, setValues] = useState<Record<string, unknown>>({});
  const [words, setWords] = useState(NO_WORDS);
  const [preset, setPreset] = useState("");
  const process = useLoaded(`process ${processId}`, (signal) =>
    askJson<Process>(`/v1/processes/${processId}`, { signal }),
  );
  const [sending, setSending] = useState(false);
  const [error, setError] = useState<unknown>(null);
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const [preview, setPreview] = useState<Region[]>([]);
  const inputs = process.value?.inputs;

  // a field may change in the very click that starts the job, before anything was drawn again
  const newest = useRef(values);
  const update = (all: Record<string, unknown>) => {
    newest.current = all;
    setValues(all);
  };
  const change = (some: Record<string, unknown>) => update({ ...newest.current, ...some });

  // the surface or package people came with goes into the first input that takes it
  const wanted = query.get("from") ?? (query.get("mesh") ? `/v1/meshes/${query.get("mesh")}` : null);
  const as = query.get("as");
  useEffect(() => {
    if (!inputs || !wanted) return;
    const kinds = wanted.endsWith("/package") ? ["package"] : as ? [as] : ["reference", "references"];
    const [name, one] = Object.entries(inputs).find(([, each]) => kinds.includes(kindOf(each.schema))) ?? [];
    if (!name || !one || newest.current[name] !== undefined) return;
    change({ [name]: kindOf(one.schema) === "references" ? [{ href: wanted }] : { href: wanted } });
  }, [inputs, wanted]);

  // the settings of an earlier job, to be changed: taken once, whatever is typed since stays
  const like = query.get("like") ?? "";
  const earlier = useLoaded(`inputs ${like}`, async (signal) => (like ? getInputs(like, signal) : null));
  const taken = useRef("");
  useEffect(() => {
    if (!earlier.value || taken.current === like) return;
    taken.current = like;
    setProcessId(earlier.value.processID);
    update(earlier.value.inputs);
  }, [earlier.value]);
  const choose = (id: string, given: Record<string, unknown>, title: string) => {
    const kept = Object.fromEntries(Object.entries(newest.current).filter(([, value]) => hrefOf(value)));
    setProcessId(id);
    update({ ...kept, ...given });
    setPreset(title);
    setError(null);
  };
  // what is left of another process is neither shown nor sent
  const known = useMemo(
    () => Object.fromEntries(Object.entries(values).filter(([name]) => inputs && name in inputs)),
    [values, inputs],
  );

  const coil = useDrawnCoil(known);
  const { surfaces, triangles, href, packed } = useInputSurfaces(known);

  const schemas = Object.fromEntries(Object.entries(inputs ?? {}).map(([name, one]) => [name, one.schema]));
  const placed = useMemo(() => findBoxes(schemas, known), [known, inputs]);
  const boxes = useMemo<RegionBox[]>(
    () => [
      ...placed.map(({ region }) => ({ name: region.name, ...region.box_mm })),
      ...preview.map((region) => ({ name: region.name, ...region.box_mm, fixed: true })),
    ],
    [placed, preview],
  );
  const moveBox = (number: number, { min, max }: RegionBox) => {
    const one = placed[number];
    if (one) update(withRegion(newest.current, one, { ...one.region, box_mm: { min, max } }));
  };

  const layerInput = Object.entries(schemas).find(([, one]) => kindOf(one) === "layers");
  const layers = layerInput ? asLayers(known[layerInput[0]] ?? layerInput[1].default).map((layer) => layer.name) : [];
  const outermost = surfaces[0] && triangles.meshes[surfaces[0].name];
  const mesh = meshes.items.find((one) => href.endsWith(one.id));
  const find = useMemo(() => (mesh ? () => findEars(mesh.id) : null), [mesh?.id]);
  const volume = meshes.items.find((one) => one.volume && hrefOf(known.volume).endsWith(one.id))?.volume;
  const context: FormContext = {
    meshes: meshes.items,
    jobs: jobs.items,
    layers,
    surfaces: layerInput
      ? ["skin", ...layers, ...asTissues(known.tissues).map((tissue) => tissue.name)]
      : (packed ?? Object.keys((known.meshes as object | undefined) ?? {})),
    arrays: mesh?.arrays.map((array) => array.name) ?? [],
    labels: volume?.labels.map((one) => one.label) ?? [],
    bounds: outermost ? { min: outermost.min, max: outermost.max } : null,
    findEars: find,
    onLook: (point) => viewer?.gaze.flyTo(point),
    onPreview: setPreview,
  };
  const start = async () => {
    setSending(true);
    setError(null);
    try {
      const sent = Object.entries(newest.current).filter(([name]) => name in schemas);
      const job = await execute(processId, withoutEmpty(Object.fromEntries(sent)), sentWords(words));
      goTo(`#/jobs/${job.jobID}`);
    } catch (reason) {
      setError(reason);
      setSending(false);
    }
  };
  const waits = surfaces.length === 0 && href && triangles.loading && !triangles.failure;
  return (
    <>
      <div class="heading">
        <h1>New job</h1>
      </div>
      <div class="bench wide-panel">
        <div class="view stack">
          <ViewerPane
            makeTree={makeTree}
            label="3D view of the surfaces with their boxes"
            surfaces={surfaces}
            boxes={boxes}
            coil={coil}
            onBox={moveBox}
            onViewer={setViewer}
            loading={waits ? "Loading the mesh…" : ""}
            failure={surfaces.length === 0 ? triangles.failure : ""}
            empty={volume ? "Surfaces are made of its labels." : "Choose a mesh to see it here."}
          />
          {placed.length > 0 && (
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
          <ProcessChoice
            processId={processId}
            description={process.value?.description ?? ""}
            preset={preset}
            onChoose={choose}
          />
          {process.error ? <Failure error={process.error} again={process.again} /> : null}
          {earlier.error ? <Failure error={earlier.error} again={earlier.again} /> : null}
          {meshes.error ? <Failure error={meshes.error} again={meshes.again} /> : null}
          {!inputs && !process.error && <p class="empty">Loading the form…</p>}
          {(meshes.showMore || search.typed) && (
            <div class="card row">
              <SearchBox label="Search the meshes to choose from" search={search} />
              <MoreButton onMore={meshes.showMore} loading={meshes.loading} />
            </div>
          )}
          {inputs && (
            <ProcessInputs
              key={processId}
              inputs={inputs}
              values={known}
              context={context}
              error={error}
              onValues={change}
            />
          )}
          <section class="card stack" aria-label="What to find it by">
            <WordsInputs words={words} onWords={setWords} />
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
