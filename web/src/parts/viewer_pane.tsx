import { useEffect, useRef, useState } from "preact/hooks";
import { messageOf } from "../api/server";
import type { TreeMaker } from "../viewer/picking";
import type { Clip, Marker, Probe, RegionBox, Surface } from "../viewer/surface";
import { Viewer } from "../viewer/viewer";
import { sayNumber } from "../words";
import { saveBlob } from "./save";

/** The viewer as a part of the page: controls over it, what is under the pointer below it. */

export interface ViewerPaneProps {
  label: string;
  surfaces: readonly Surface[];
  clip?: Clip | null;
  markers?: readonly Marker[];
  boxes?: readonly RegionBox[];
  /** Places of a coil beside the surfaces, x, y, z in mm one after the other. */
  coil?: Float32Array | null;
  onBox?: (number: number, box: RegionBox) => void;
  onViewer?: (viewer: Viewer | null) => void;
  /** Search trees made beside the page. */
  makeTree?: TreeMaker;
  loading?: string;
  failure?: string;
  empty?: string;
}

const VIEWS: Record<string, [number, number, number]> = {
  "+x": [1, 0, 0],
  "−x": [-1, 0, 0],
  "+y": [0, 1, 0.001],
  "−y": [0, -1, 0.001],
  "+z": [0, 0.001, 1],
  "−z": [0, 0.001, -1],
};
const NO_CLIP = null;
const NONE: never[] = [];

export function ViewerPane(props: ViewerPaneProps) {
  const { label, surfaces, clip = NO_CLIP, markers = NONE, boxes = NONE, coil = null, loading, failure, empty } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  const events = useRef(props);
  events.current = props;
  const [viewer, setViewer] = useState<Viewer | null>(null);
  const [broken, setBroken] = useState("");
  const [probe, setProbe] = useState<Probe | null>(null);

  useEffect(() => {
    let made: Viewer;
    try {
      made = new Viewer(canvas.current!, {
        onProbe: setProbe,
        onBox: (number, box) => events.current.onBox?.(number, box),
        ...(props.makeTree ? { makeTree: props.makeTree } : {}),
      });
    } catch (error) {
      setBroken(`This browser cannot draw in 3D (WebGL 2): ${messageOf(error)} Everything else on this page works.`);
      return;
    }
    const colour = () => {
      const style = getComputedStyle(document.documentElement);
      made.setBackground(style.getPropertyValue("--scene").trim() || "#eef2f4");
    };
    colour();
    const dark = matchMedia("(prefers-color-scheme: dark)");
    addEventListener("integument-theme", colour);
    dark.addEventListener("change", colour);
    setViewer(made);
    return () => {
      removeEventListener("integument-theme", colour);
      dark.removeEventListener("change", colour);
      events.current.onViewer?.(null);
      made.dispose();
    };
  }, []);
  useEffect(() => viewer?.setSurfaces(surfaces), [viewer, surfaces]);
  useEffect(() => viewer?.setClip(clip), [viewer, clip]);
  useEffect(() => viewer?.setMarkers(markers), [viewer, markers]);
  useEffect(() => viewer?.setBoxes(boxes), [viewer, boxes]);
  useEffect(() => viewer?.setCoil(coil), [viewer, coil]);
  // only now: whoever takes the viewer over finds the surfaces in place
  useEffect(() => {
    if (viewer) events.current.onViewer?.(viewer);
  }, [viewer]);

  const shoot = async () => {
    const picture = await viewer?.screenshot();
    if (picture) saveBlob(picture, "integument.png");
  };
  const said = broken || failure || loading || (surfaces.length === 0 ? empty : "");
  const under = probe && !probe.inSection ? surfaces.find((one) => one.name === probe.surface) : undefined;
  const field = under?.field;
  return (
    <div class="viewer" data-ready={viewer !== null && surfaces.length > 0 && !said}>
      <canvas
        ref={canvas}
        tabIndex={0}
        role="img"
        aria-label={`${label}. Arrow keys turn it, with Shift they move it, plus and minus zoom, Home shows all of it, Enter reads what is in the middle.`}
      />
      <span class="cross" aria-hidden="true" />
      {said ? (
        <div class="state" role={broken || failure ? "alert" : "status"}>
          {loading && !failure && !broken && <progress aria-label="Loading the mesh" />}
          <p>{said}</p>
        </div>
      ) : (
        <>
          <fieldset class="overlay top">
            <legend class="hidden-label">View</legend>
            <button type="button" onClick={() => viewer?.gaze.fit()}>
              Fit
            </button>
            {Object.entries(VIEWS).map(([name, direction]) => (
              <button
                key={name}
                type="button"
                title={`Look from ${name}`}
                onClick={() => viewer?.gaze.lookFrom(direction)}
              >
                {name}
              </button>
            ))}
            <button type="button" onClick={shoot}>
              Save picture
            </button>
          </fieldset>
          {!probe && surfaces.length === 1 && <div class="overlay bottom caption">{surfaces[0]!.name}</div>}
          <div class="overlay bottom" aria-live="polite">
            {probe && (
              <div class="readout">
                <b>{probe.surface}</b> ({probe.point.map((value) => value.toFixed(1)).join(", ")}) mm
                {probe.inSection && " · in the section"}
                {field && ` · ${field.name} `}
                {field && (probe.value === null ? "has no value here" : <b>{sayNumber(probe.value)}</b>)}
                {field && probe.value !== null && ` ${field.unit}`}
                {field && under?.thinned && " · of the coarser surface shown"}
              </div>
            )}
          </div>
        </>
      )}
    </div>
  );
}
