import { tissueColours } from "../tissues";
import { NumberInput } from "./number_input";
import { RemoveButton, RemoveHeading } from "./remove_button";
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
      <div class="scroll-x">
        <table>
          <thead>
            <tr>
              <th>Layer</th>
              <th>Depth (mm)</th>
              <th>Side</th>
              <RemoveHeading />
            </tr>
          </thead>
          <tbody>
            {layers.map((layer, at) => (
              <tr key={at}>
                <td>
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
                </td>
                <td>
                  {arrays.length > 0 && (
                    <select
                      aria-label={`Depth of layer ${at + 1}: a number or an array of the mesh`}
                      value={layer.depth_array ?? ""}
                      onChange={(event) => {
                        const array = event.currentTarget.value || undefined;
                        change(at, { depth_array: array, depth_mm: array ? undefined : (layer.depth_mm ?? 1) });
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
                      label={`Depth of layer ${at + 1} in mm`}
                      value={layer.depth_mm}
                      min={0}
                      max={100}
                      onValue={(depth_mm) => change(at, { depth_mm })}
                    />
                  )}
                </td>
                <td>
                  <select
                    aria-label={`Side of layer ${at + 1}`}
                    value={layer.side ?? "inside"}
                    onChange={(event) => change(at, { side: event.currentTarget.value as "inside" | "outside" })}
                  >
                    <option value="inside">inside</option>
                    <option value="outside">outside</option>
                  </select>
                </td>
                <td>
                  <RemoveButton
                    what={`layer ${layer.name}`}
                    disabled={layers.length === 1}
                    onRemove={() => onLayers(layers.filter((_, i) => i !== at))}
                  />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <div>
        <button type="button" onClick={add} disabled={layers.length >= 16}>
          Add a layer
        </button>
      </div>
    </div>
  );
}

export function Swatch({ colour }: { colour: string }) {
  return (
    <svg class="swatch" viewBox="0 0 12 12" aria-hidden="true">
      <rect width="12" height="12" rx="3" fill={colour} />
    </svg>
  );
}
