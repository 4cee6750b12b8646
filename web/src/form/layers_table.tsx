import { Swatch } from "../parts/swatch";
import { Table } from "../parts/table";
import { tissueColours } from "../tissues";
import { NumberInput } from "./number_input";
import { removeColumn } from "./remove_button";
import { freshName, type Layer } from "./values";

/** Layers from outside inwards, each with its depth and the colour it will be shown in. */
export function LayersTable(props: {
  layers: Layer[];
  arrays: readonly string[];
  onLayers: (layers: Layer[]) => void;
}) {
  const { layers, arrays, onLayers } = props;
  const colours = tissueColours(["skin", ...layers.map((layer) => layer.name)]);
  const change = (at: number, part: Partial<Layer>) =>
    onLayers(layers.map((layer, i) => (i === at ? { ...layer, ...part } : layer)));
  const add = () => {
    const deepest = Math.max(
      0,
      ...layers.filter((layer) => layer.side !== "outside").map((layer) => layer.depth_mm ?? 0),
    );
    onLayers([
      ...layers,
      {
        name: freshName(
          "layer",
          layers.map((layer) => layer.name),
        ),
        depth_mm: deepest + 1,
        side: "inside",
      },
    ]);
  };
  return (
    <div class="stack">
      <Table
        rows={layers}
        keyOf={(_, at) => at}
        columns={[
          {
            title: "Layer",
            cell: (layer, at) => (
              <span class="row nowrap">
                <Swatch colour={colours[layer.name]!} />
                <input
                  class="layer-name"
                  aria-label={`Name of layer ${at + 1}`}
                  value={layer.name}
                  size={13}
                  onInput={(event) => change(at, { name: event.currentTarget.value })}
                />
              </span>
            ),
          },
          {
            title: "Depth (mm)",
            cell: (layer, at) => (
              <Depth layer={layer} number={at + 1} arrays={arrays} onChange={(part) => change(at, part)} />
            ),
          },
          {
            title: "Side",
            cell: (layer, at) => (
              <select
                aria-label={`Side of layer ${at + 1}`}
                value={layer.side ?? "inside"}
                onChange={(event) => change(at, { side: event.currentTarget.value as "inside" | "outside" })}
              >
                <option value="inside">inside</option>
                <option value="outside">outside</option>
              </select>
            ),
          },
          removeColumn<Layer>(
            (layer) => `layer ${layer.name}`,
            (layer) => onLayers(layers.filter((one) => one !== layer)),
            layers.length === 1,
          ),
        ]}
      />
      <div>
        <button type="button" onClick={add} disabled={layers.length >= 16}>
          Add a layer
        </button>
      </div>
    </div>
  );
}

/** In mm, or by an array the mesh came with. */
function Depth(props: {
  layer: Layer;
  number: number;
  arrays: readonly string[];
  onChange: (part: Partial<Layer>) => void;
}) {
  const { layer, number, arrays, onChange } = props;
  return (
    <>
      {arrays.length > 0 && (
        <select
          aria-label={`Depth of layer ${number}: a number or an array of the mesh`}
          value={layer.depth_array ?? ""}
          onChange={(event) => {
            const array = event.currentTarget.value || undefined;
            onChange({ depth_array: array, depth_mm: array ? undefined : (layer.depth_mm ?? 1) });
          }}
        >
          <option value="">number</option>
          {arrays.map((array) => (
            <option key={array}>{array}</option>
          ))}
        </select>
      )}
      {!layer.depth_array && (
        <NumberInput
          label={`Depth of layer ${number} in mm`}
          value={layer.depth_mm}
          min={0}
          max={100}
          onValue={(depth_mm) => onChange({ depth_mm })}
        />
      )}
    </>
  );
}
