import type { Schema } from "../api/types";
import type { Bounds } from "../mesh/triangles";
import { NumberInput } from "./number_input";
import { NumbersByName } from "./numbers_by_name";
import { kindOf, labelOf } from "./schema_kind";
import { asNumbers, freshName, LARGEST_DEPTH_MM, type Region } from "./values";

const AXES = ["x", "y", "z"] as const;

/** Boxes, typed as numbers here and dragged by their handles in the view. */
export function RegionsInput(props: {
  what: string;
  schema: Schema;
  regions: Region[];
  layers: readonly string[];
  bounds: Bounds | null;
  onLook: (point: [number, number, number]) => void;
  onRegions: (regions: Region[]) => void;
}) {
  const { what, schema, regions, layers, bounds, onRegions } = props;
  const change = (at: number, part: Partial<Region>) =>
    onRegions(regions.map((region, i) => (i === at ? ({ ...region, ...part } as Region) : region)));
  const more = Object.entries(schema.properties ?? {}).filter(([name]) => name !== "name" && name !== "box_mm");
  return (
    <div class="stack">
      {regions.map((region, at) => (
        <fieldset key={at} class="item">
          <legend class="hidden-label">{region.name}</legend>
          <div class="row spread">
            <input
              aria-label={`Name of ${what} ${at + 1}`}
              value={region.name}
              size={16}
              onInput={(event) => change(at, { name: event.currentTarget.value })}
            />
            <button
              type="button"
              class="quiet"
              aria-label={`Look at ${region.name}`}
              onClick={() => props.onLook(middleOf(region))}
            >
              Look
            </button>
            <button
              type="button"
              class="quiet"
              aria-label={`Remove ${region.name}`}
              onClick={() => onRegions(regions.filter((_, i) => i !== at))}
            >
              ✕
            </button>
          </div>
          {(["min", "max"] as const).map((end) => (
            <div key={end} class="vector">
              <span class="muted small">{end}</span>
              {AXES.map((axis, k) => (
                <NumberInput
                  key={axis}
                  label={`${region.name}: ${end} ${axis} in mm`}
                  value={region.box_mm[end][k]}
                  onValue={(value) => {
                    if (value === undefined) return; // a minus alone is the beginning of a number
                    const corner = [...region.box_mm[end]] as [number, number, number];
                    corner[k] = value;
                    change(at, { box_mm: { ...region.box_mm, [end]: corner } });
                  }}
                />
              ))}
            </div>
          ))}
          {more.map(([name, one]) =>
            kindOf(one) === "depths" ? (
              <div key={name}>
                <NumbersByName
                  of={`${region.name}, depth in mm`}
                  values={asNumbers(region[name])}
                  names={layers}
                  min={0}
                  max={LARGEST_DEPTH_MM}
                  onValues={(depths) => change(at, { [name]: Object.keys(depths).length ? depths : undefined })}
                />
              </div>
            ) : (
              <label key={name} class="row small">
                {labelOf(name)}
                <NumberInput
                  value={region[name] as number | undefined}
                  placeholder={one.default === null || one.default === undefined ? "" : String(one.default)}
                  onValue={(value) => change(at, { [name]: value })}
                />
              </label>
            ),
          )}
        </fieldset>
      ))}
      <div>
        <button
          type="button"
          disabled={regions.length >= (schema.maxItems ?? 32)}
          onClick={() => onRegions([...regions, newRegion(what, regions, layers, more, bounds)])}
        >
          Add a box
        </button>
      </div>
    </div>
  );
}

export function middleOf({ box_mm: { min, max } }: Region): [number, number, number] {
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
}

/** A box in the middle of the body, a fifth of its size, to be dragged from there. */
function newRegion(
  what: string,
  regions: readonly Region[],
  layers: readonly string[],
  more: [string, Schema][],
  bounds: Bounds | null,
): Region {
  const { min, max } = bounds ?? { min: [-50, -50, -50], max: [50, 50, 50] };
  const corner = (share: number) =>
    min.map((low, axis) => Math.round(low + share * (max[axis]! - low))) as [number, number, number];
  const needed = more.filter(([, one]) => kindOf(one) === "depths" && one.default === undefined);
  return {
    name: freshName(
      what,
      regions.map((region) => region.name),
    ),
    box_mm: { min: corner(0.4), max: corner(0.6) },
    ...Object.fromEntries(needed.map(([name]) => [name, layers[0] ? { [layers[0]]: 0.5 } : {}])),
  };
}
