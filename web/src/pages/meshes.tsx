import { useMemo, useState } from "preact/hooks";
import { deleteMesh, listMeshes } from "../api/meshes";
import type { Finding, MeshInfo } from "../api/types";
import { makeTree } from "../mesh/workshop";
import { ConfirmedButton } from "../parts/confirmed_button";
import { DropZone } from "../parts/drop_zone";
import { Failure } from "../parts/failure";
import { Findings } from "../parts/findings";
import { MoreButton, useLongList } from "../parts/long_list";
import { QuickCheck } from "../parts/quick_check";
import { SearchBox, useSettled } from "../parts/search_box";
import { ThinnedNote } from "../parts/thinned_note";
import { useTriangles } from "../parts/triangles_of";
import { type Local, UploadItem } from "../parts/upload_item";
import { ViewerPane } from "../parts/viewer_pane";
import { goTo } from "../router";
import { tissueColours } from "../tissues";
import { sayLength } from "../units";
import type { Marker, Point, Surface } from "../viewer/surface";
import type { Viewer } from "../viewer/viewer";
import { isSurface, sayContent, sayWhen } from "../words";

const NONE: Marker[] = [];
const FEW = 5;
const FIRST = 100;
const CHECKED_FACES = 500_000; // of larger ones the check takes minutes: it waits for a click

/** Where an upload that is no surface goes first. */
function jobOf({ volume, field, coil }: MeshInfo): string {
  if (volume) return "&process=segment&as=volume";
  if (field) return "&process=fields&as=field";
  return coil ? "&process=fields&as=coil" : "";
}

/** The way in: drop files, say their unit, see them, go on to a job. */
export function MeshesPage({ chosenId }: { chosenId: string | undefined }) {
  const search = useSettled("");
  const list = useLongList(
    `meshes ${search.settled}`,
    (count, signal) => listMeshes(count, search.settled, signal),
    FIRST,
  );
  const [files, setFiles] = useState<{ number: number; file: File }[]>([]);
  const [local, setLocal] = useState<Local | null>(null);
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const [justAdded, setJustAdded] = useState("");
  const [refused, setRefused] = useState<unknown>(null);
  const [marked, setMarked] = useState<{ of: string; places: Marker[] }>({ of: "", places: [] });
  const meshes = list.items;
  const chosen = local ? undefined : (meshes.find((mesh) => mesh.id === chosenId) ?? meshes[0]);
  const fetched = useTriangles(chosen && isSurface(chosen) ? { [chosen.name]: `/v1/meshes/${chosen.id}` } : {});
  const shown = local?.mesh ?? (chosen ? fetched.meshes[chosen.name] : undefined);
  const name = local?.name ?? chosen?.name ?? "";
  const surfaces = useMemo<Surface[]>(
    () =>
      shown
        ? [
            {
              name,
              mesh: shown.shown,
              colour: tissueColours(["skin"]).skin!,
              visible: true,
              opacity: 1,
              closed: shown.closed,
              field: null,
            },
          ]
        : [],
    [shown, name],
  );
  const add = (more: File[]) =>
    setFiles([...files, ...more.map((file, i) => ({ number: (files.at(-1)?.number ?? 0) + i + 1, file }))]);
  const remove = (number: number) => {
    setFiles(files.filter((one) => one.number !== number));
    setLocal(null);
  };
  const added = (number: number, mesh: MeshInfo) => {
    remove(number);
    setJustAdded(mesh.id);
    list.again();
    goTo(`#/?mesh=${mesh.id}`);
  };
  const forget = async (mesh: MeshInfo) => {
    try {
      await deleteMesh(mesh.id);
      list.again();
    } catch (error) {
      setRefused(error);
    }
  };
  const fly = (point: Point, { places, severity }: Finding) => {
    setMarked({ of: chosen?.id ?? "", places: places.map((place) => ({ point: place.point_mm, severity })) });
    viewer?.gaze.flyTo(point);
  };
  const nothing = !list.loading && !list.error && !search.settled && meshes.length === 0 && files.length === 0;
  return (
    <>
      <div class="heading">
        <h1>Meshes</h1>
      </div>
      {list.error ? <Failure error={list.error} again={list.again} /> : null}
      {refused ? <Failure error={refused} /> : null}
      {list.loading && !list.known && <p class="empty">Looking what the server holds…</p>}
      {nothing && (
        <div class="stack">
          <DropZone onFiles={add} />
          <ol class="steps">
            <li class="card">
              <h2>1. Bring the skin</h2>
              <p class="muted">
                A closed surface of a body or a head, as STL, MAT, PLY or OBJ, in any of four units; or labels of
                tissues, as NIfTI or MGZ.
              </p>
            </li>
            <li class="card">
              <h2>2. Choose layers and ears</h2>
              <p class="muted">
                Depths below the skin, thinner in the ears if you like. The thesis' settings are one click.
              </p>
            </li>
            <li class="card">
              <h2>3. Look inside</h2>
              <p class="muted">Proven nested shells in a cut view, with a report and files for your solver.</p>
            </li>
          </ol>
        </div>
      )}
      {(files.length > 0 || meshes.length > 0 || search.settled) && (
        <div class="bench">
          <div class="view">
            <ViewerPane
              makeTree={makeTree}
              label={`3D view of ${name}`}
              surfaces={surfaces}
              markers={marked.of === chosen?.id ? marked.places : NONE}
              onViewer={setViewer}
              loading={
                chosen && isSurface(chosen) && !shown && fetched.loading && !fetched.failure ? `Loading ${name}…` : ""
              }
              failure={fetched.failure}
              empty={
                chosen
                  ? chosen.volume
                    ? "Make surfaces of its labels to see it."
                    : "This is no surface: a job puts it on one."
                  : "Choose a mesh to see it."
              }
            />
            <ThinnedNote meshes={shown ? [shown] : []} />
          </div>
          <div class="stack">
            <DropZone onFiles={add} small />
            {files.map(({ number, file }) => (
              <UploadItem
                key={number}
                file={file}
                onLocal={setLocal}
                onDone={(mesh) => added(number, mesh)}
                onRemove={() => remove(number)}
              />
            ))}
            {(search.typed || meshes.length > FEW) && <SearchBox label="Search meshes" search={search} />}
            {meshes.length === 0 && search.settled && <p class="card empty">No mesh matches the search.</p>}
            <ul class="list" aria-label="Meshes on the server">
              {meshes.map((mesh) => (
                <li key={mesh.id} class={mesh === chosen ? "item chosen" : "item"}>
                  <div class="row spread">
                    <span class="name">{mesh.name}</span>
                    <span class="muted small">{sayWhen(mesh.created)}</span>
                  </div>
                  <span class="muted small">
                    {[
                      sayContent(mesh),
                      Math.max(...mesh.extents_mm) > 0 ? mesh.extents_mm.map(sayLength).join(" × ") : [],
                      `${mesh.format.toUpperCase()} in ${mesh.unit}`,
                    ]
                      .flat()
                      .join(" · ")}
                  </span>
                  {mesh === chosen && (
                    <>
                      {mesh.findings.length > 0 && <Findings findings={mesh.findings} onPlace={fly} />}
                      {isSurface(mesh) && (
                        <QuickCheck
                          mesh={mesh}
                          atOnce={mesh.id === justAdded && mesh.faces <= CHECKED_FACES}
                          onPlace={fly}
                        />
                      )}
                    </>
                  )}
                  <div class="row">
                    <a class="button primary" href={`#/new?mesh=${mesh.id}${jobOf(mesh)}`}>
                      Set up a job
                    </a>
                    {mesh !== chosen && (
                      <button
                        type="button"
                        aria-label={`Show ${mesh.name}`}
                        onClick={() => {
                          setLocal(null);
                          goTo(`#/?mesh=${mesh.id}`);
                        }}
                      >
                        Show
                      </button>
                    )}
                    <ConfirmedButton label="Delete" about={`Delete ${mesh.name}`} onConfirmed={() => forget(mesh)} />
                  </div>
                </li>
              ))}
            </ul>
            <MoreButton onMore={list.showMore} loading={list.loading} />
          </div>
        </div>
      )}
    </>
  );
}
