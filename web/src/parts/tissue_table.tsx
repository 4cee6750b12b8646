import { Swatch } from "../form/layers_table";
import type { Surface } from "../viewer/surface";

/** Visibility, opacity and colour of every surface. */
export function TissueTable(props: {
  surfaces: readonly Surface[];
  onChange: (name: string, part: Partial<Surface>) => void;
}) {
  const { surfaces, onChange } = props;
  return (
    <div class="scroll-x">
      <table class="tissues">
        <thead>
          <tr>
            <th>Surface</th>
            <th>Show</th>
            <th>Opacity</th>
            <th>Colour</th>
          </tr>
        </thead>
        <tbody>
          {surfaces.map((one) => (
            <tr key={one.name}>
              <td>
                <span class="row name">
                  <Swatch colour={one.colour} /> {one.name}
                </span>
              </td>
              <td>
                <input
                  type="checkbox"
                  aria-label={`Show ${one.name}`}
                  checked={one.visible}
                  onChange={(event) => onChange(one.name, { visible: event.currentTarget.checked })}
                />
              </td>
              <td>
                <input
                  type="range"
                  aria-label={`Opacity of ${one.name}`}
                  min={0.05}
                  max={1}
                  step={0.05}
                  value={one.opacity}
                  onInput={(event) => onChange(one.name, { opacity: event.currentTarget.valueAsNumber })}
                />
              </td>
              <td>
                <input
                  type="color"
                  aria-label={`Colour of ${one.name}`}
                  value={one.colour}
                  onInput={(event) => onChange(one.name, { colour: event.currentTarget.value })}
                />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
