import { useMemo, useState } from "preact/hooks";
import { getInputs, getOutputs, getReport } from "../api/jobs";
import { ServerError } from "../api/server";
import type { Finding, Job, Report, ResultReference } from "../api/types";
import { makeTree } from "../mesh/workshop";
import { tissueColours } from "../tissues";
import type { Clip, Marker, Point, Surface } from "../viewer/surface";
import type { Viewer } from "../viewer/viewer";
import { plain } from "../words";
import { Beside } from "./beside";
import { ClipControl } from "./clip_control";
import { Downloads } from "./downloads";
import { useDrawnCoil } from "./drawn_coil";
import { Failure } from "./failure";
import { FieldControl } from "./field_control";
import { useFields } from "./fields_of";
import { Findings } from "./findings";
import { useLoaded } from "./loaded";
import { Numbers } from "./numbers";
import { outsideIn } from "./outside_in";
import { useShownSurfaces } from "./shown_surfaces";
import { ThinnedNote } from "./thinned_note";
import { TissueTable } from "./tissue_table";
import { ViewerPane } from "./viewer_pane";

const BEFORE = " before";

type Looks = Record<string, Partial<Pick<Surface, "visible" | "opacity" | "colour">>>;

function surfaceIsShown(name: string, looks: Looks): boolean {
  return looks[name]?.visible ?? !name.endsWith(BEFORE);
}

/** What came of a job: its surfaces, cut open and coloured as one likes, its findings, numbers and files. */
export function ResultView({ job }: { job: Job }) {
  const report = useLoaded<Report | null>(`report ${job.jobID}`, (signal) => getReport(job.jobID, signal));
  const results = useLoaded<Record<string, ResultReference>>(`results ${job.jobID} ${job.links.length}`, (signal) =>
    getOutputs(job, signal),
  );
  const inputs = useLoaded(`inputs ${job.jobID}`, (signal) => getInputs(job.jobID, signal));
  const triangles = useShownSurfaces(results.value, inputs.value?.inputs ?? null, report.value);
  const coil = useDrawnCoil(inputs.value?.inputs ?? null);
  const [looks, setLooks] = useState<Looks>({});
  const [clip, setClip] = useState<Clip | null>(null);
  const { choice, choose, fields, range, setRange, solved, failure } = useFields(triangles.meshes);
  const [markers, setMarkers] = useState<Marker[]>([]);
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const [withCoil, setWithCoil] = useState(true);
  const [beside, setBeside] = useState(false);

  const names = outsideIn(triangles.meshes);
  const colours = tissueColours(names);
  const measured = choice
    ? names.flatMap((name) => (fields[name] && surfaceIsShown(name, looks) ? [fields[name]] : []))
    : [];
  const usual: [number, number] = [
    Math.min(...measured.map((field) => field.low)),
    Math.max(...measured.map((field) => field.high)),
  ];
  const [low, high] = range ?? usual;
  const surfaces = useMemo<Surface[]>(
    () =>
      names.map((name) => {
        const mesh = triangles.meshes[name]!;
        const field = choice && fields[name];
        return {
          name,
          mesh: mesh.shown,
          colour: colours[name]!,
          visible: !name.endsWith(BEFORE),
          opacity: 1,
          closed: mesh.closed,
          thinned: mesh.thinned,
          ...looks[name],
          field: field ? { ...field, low, high } : null,
        };
      }),
    [triangles.meshes, looks, fields, choice, low, high],
  );
  const fly = (point: Point, finding: Finding) => {
    setMarkers(finding.places.map((place) => ({ point: place.point_mm, severity: finding.severity })));
    if (clip && (clip.keep === "below" ? point[clip.axis] > clip.at : point[clip.axis] < clip.at)) setClip(null);
    viewer?.gaze.flyTo(point);
    document.querySelector(".viewer")?.scrollIntoView({ block: "nearest" });
  };
  const look = (name: string, part: Looks[string]) => setLooks({ ...looks, [name]: { ...looks[name], ...part } });
  const bounds = names[0] ? triangles.meshes[names[0]]! : null;
  const known = results.value !== null && inputs.value !== null;
  const loading = names.length === 0 && (!known || (triangles.loading && !triangles.failure));
  const refused = results.error ?? inputs.error ?? (isMissing(report.error) ? null : report.error);
  return (
    <div class="bench result">
      <div class="view stack">
        <div class={beside ? "pair" : ""}>
          <ViewerPane
            makeTree={makeTree}
            label={beside ? `3D view of ${names[0]}` : "3D view of the result"}
            surfaces={beside ? surfaces.slice(0, 1) : surfaces}
            clip={clip}
            markers={markers}
            coil={withCoil ? coil : null}
            onViewer={setViewer}
            loading={loading ? "Loading the surfaces…" : ""}
            failure={triangles.failure}
            empty={`This job left no surface to show${report.value ? "; its report says why" : ""}.`}
          />
          {beside && <Beside surfaces={surfaces} clip={clip} markers={markers} leader={viewer} />}
        </div>
        {refused ? <Failure error={refused} again={() => [report, results, inputs].map((one) => one.again())} /> : null}
        <ThinnedNote meshes={Object.values(triangles.meshes)} />
        {job.summary && <p>{plain(job.summary)}</p>}
      </div>
      <div class="numbers">{report.value && <Numbers report={report.value} />}</div>
      <div class="stack side">
        {bounds && (
          <section class="card stack" aria-label="View">
            <TissueTable surfaces={surfaces} onChange={look} />
            <ClipControl clip={clip} bounds={bounds} onClip={setClip} />
            <FieldControl
              names={names}
              solved={solved}
              thinned={surfaces.some((one) => one.thinned && one.visible)}
              choice={choice}
              field={measured[0] ? { ...measured[0], low, high } : null}
              failure={failure}
              onChoice={choose}
              onRange={(low, high) => setRange([low, high])}
            />
            {coil && (
              <label class="row">
                <input
                  type="checkbox"
                  checked={withCoil}
                  onChange={(event) => setWithCoil(event.currentTarget.checked)}
                />
                The coil
              </label>
            )}
            {names.length > 1 && (
              <label class="row">
                <input type="checkbox" checked={beside} onChange={(event) => setBeside(event.currentTarget.checked)} />
                Two surfaces side by side
              </label>
            )}
          </section>
        )}
        <Downloads job={job} results={results.value} hasReport={report.value !== null} />
        {report.value && (
          <section class="card stack" aria-label="Findings">
            <h2>Findings</h2>
            <Findings findings={report.value.findings} onPlace={fly} />
          </section>
        )}
      </div>
    </div>
  );
}

/** A job that never came far has no report. */
function isMissing(error: unknown): boolean {
  return error instanceof ServerError && error.status === 404;
}
