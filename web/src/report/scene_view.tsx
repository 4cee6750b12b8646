import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Painted, SceneAbout, SceneMesh } from "../mesh/scene";
import { boundsOfAll } from "../mesh/triangles";
import { ClipControl } from "../parts/clip_control";
import { Legend } from "../parts/legend";
import { TissueTable } from "../parts/tissue_table";
import { ViewerPane } from "../parts/viewer_pane";
import { usualRange } from "../viewer/colour_map";
import type { Clip, Field, Surface } from "../viewer/surface";
import type { Viewer } from "../viewer/viewer";
import type { Place } from "./places";

const DEPTH: Painted = { name: "distance to the skin", unit: "mm", shown: false };
const BEFORE = " before"; // what a surface was made from: hidden until asked for

/** The surfaces of a report: seen through, cut open, with the places its tables name. */
export function SceneView({ about, meshes, places }: { about: SceneAbout; meshes: SceneMesh[]; places: Place[] }) {
  const paintedBy = about.painted ?? DEPTH;
  const [surfaces, setSurfaces] = useState<Surface[]>(() =>
    about.surfaces.map(({ name, colour, closed }, i) => ({
      ...{ name, colour, closed, mesh: meshes[i]!.mesh },
      ...{
        visible: !name.endsWith(BEFORE),
        opacity: 1,
        field: paintedBy.shown ? fieldOf(meshes[i]!, paintedBy) : null,
      },
    })),
  );
  const bounds = useMemo(() => boundsOfAll(meshes.map(({ mesh }) => mesh)), [meshes]);
  const [clip, setClip] = useState<Clip | null>(null);
  const [marked, setMarked] = useState<"all" | "none" | Place>(
    () => (places.some(({ marker }) => marker.severity === "error") ? "all" : "none"), // they would hide what is ready
  );
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const markers = useMemo(() => {
    if (marked === "none") return [];
    return (marked === "all" ? places : [marked]).map((place) => place.marker);
  }, [marked, places]);

  useEffect(() => {
    if (!viewer) return;
    const buttons = places.map((place) => {
      const { element, marker } = place;
      const button = document.createElement("button");
      button.type = "button";
      button.className = "show-place";
      button.textContent = "show";
      button.setAttribute("aria-label", `Show ${element.textContent} in 3D`);
      button.addEventListener("click", () => {
        setMarked(place);
        setClip(null);
        viewer.gaze.flyTo(marker.point);
        viewer.canvas.scrollIntoView({ block: "center" });
        viewer.canvas.focus({ preventScroll: true });
      });
      element.after(" ", button);
      return button;
    });
    return () => {
      for (const button of buttons) button.remove();
    };
  }, [viewer, places]);

  const paper = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const print = () => {
      if (!paper.current || !viewer) return;
      viewer.copyTo(paper.current, "#ffffff");
      paper.current.className = "printed drawn"; // an empty one would leave a heading over nothing
    };
    addEventListener("beforeprint", print);
    return () => removeEventListener("beforeprint", print);
  }, [viewer]);

  const painted = surfaces.some((one) => one.field !== null);
  const paint = (on: boolean) =>
    setSurfaces(surfaces.map((one, i) => ({ ...one, field: on ? fieldOf(meshes[i]!, paintedBy) : null })));
  const change = (name: string, part: Partial<Surface>) =>
    setSurfaces(surfaces.map((one) => (one.name === name ? { ...one, ...part } : one)));
  return (
    <div class="scene">
      <ViewerPane label="The surfaces in 3D" surfaces={surfaces} clip={clip} markers={markers} onViewer={setViewer} />
      <canvas ref={paper} class="printed" />
      <div class="stack">
        <TissueTable surfaces={surfaces} onChange={change} />
        <ClipControl clip={clip} bounds={bounds} onClip={setClip} />
        {meshes.some(({ depths }) => depths !== null) && (
          <label class="row">
            <input type="checkbox" checked={painted} onChange={(event) => paint(event.currentTarget.checked)} />
            {paintedBy === DEPTH ? "Depth: distance to the skin" : paintedBy.name}, in colours
          </label>
        )}
        {surfaces.map(
          ({ name, visible, field }) =>
            visible &&
            field && (
              <div key={name} class="stack">
                {name}
                <Legend field={field} onRange={(low, high) => change(name, { field: { ...field, low, high } })} />
              </div>
            ),
        )}
        {places.length > 0 && (
          <label class="row">
            <input
              type="checkbox"
              checked={marked === "all"}
              onChange={(event) => setMarked(event.currentTarget.checked ? "all" : "none")}
            />
            {places.length === 1 ? "The place" : `All ${places.length} places`} the tables name
          </label>
        )}
      </div>
    </div>
  );
}

function fieldOf({ depths }: SceneMesh, { name, unit }: Painted): Field | null {
  if (!depths) return null;
  const [low, high] = usualRange(depths);
  return {
    name,
    unit,
    values: depths,
    each: "vertex",
    low: Math.min(low, 0.5 * high),
    high,
    map: "viridis",
  };
}
