import type { Bounds } from "../mesh/triangles";
import { AXES, type Axis, type Clip } from "../viewer/surface";

/** Where the body is cut open. */
export function ClipControl({
  clip,
  bounds,
  onClip,
}: {
  clip: Clip | null;
  bounds: Bounds;
  onClip: (clip: Clip | null) => void;
}) {
  const choose = (axis: Axis) => {
    if (clip?.axis === axis) onClip(null);
    else onClip({ axis, at: middle(bounds, axis), keep: clip?.keep ?? "below" });
  };
  const step = clip ? (bounds.max[clip.axis]! - bounds.min[clip.axis]!) / 500 : 1;
  return (
    <fieldset class="stack">
      <legend>Cut</legend>
      <div class="row">
        {AXES.map((name, axis) => (
          <button
            key={name}
            type="button"
            aria-pressed={clip?.axis === axis}
            aria-label={`Cut across ${name}`}
            onClick={() => choose(axis as Axis)}
          >
            {name}
          </button>
        ))}
        {clip && (
          <button type="button" onClick={() => onClip({ ...clip, keep: clip.keep === "below" ? "above" : "below" })}>
            Other side
          </button>
        )}
      </div>
      {clip && (
        <div class="row">
          <input
            type="range"
            aria-label={`Place of the cut on ${AXES[clip.axis]} in mm`}
            min={bounds.min[clip.axis]}
            max={bounds.max[clip.axis]}
            step={step}
            value={clip.at}
            onInput={(event) => onClip({ ...clip, at: event.currentTarget.valueAsNumber })}
          />
          <input
            type="number"
            aria-label={`${AXES[clip.axis]} of the cut in mm`}
            step="any"
            value={Number(clip.at.toFixed(2))}
            onChange={(event) => {
              const at = event.currentTarget.valueAsNumber;
              if (!Number.isNaN(at)) onClip({ ...clip, at });
            }}
          />
          mm
        </div>
      )}
    </fieldset>
  );
}

/** Not quite the middle: a plane of symmetry often lies there, full of vertices. */
function middle(bounds: Bounds, axis: Axis): number {
  const [low, high] = [bounds.min[axis]!, bounds.max[axis]!];
  return low + 0.503 * (high - low);
}
