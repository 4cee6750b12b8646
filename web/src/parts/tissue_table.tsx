import type { Surface } from "../viewer/surface";
import { Swatch } from "./swatch";
import { Table } from "./table";

/** Visibility, opacity and colour of every surface. */
export function TissueTable(props: {
  surfaces: readonly Surface[];
  onChange: (name: string, part: Partial<Surface>) => void;
}) {
  const { surfaces, onChange } = props;
  return (
    <Table
      class="tissues"
      rows={surfaces}
      keyOf={(one) => one.name}
      columns={[
        {
          title: "Surface",
          cell: ({ name, colour }) => (
            <span class="row nowrap name">
              <Swatch colour={colour} /> {name}
            </span>
          ),
        },
        {
          title: "Show",
          cell: ({ name, visible }) => (
            <input
              type="checkbox"
              aria-label={`Show ${name}`}
              checked={visible}
              onChange={(event) => onChange(name, { visible: event.currentTarget.checked })}
            />
          ),
        },
        {
          title: "Opacity",
          cell: ({ name, opacity }) => (
            <input
              type="range"
              aria-label={`Opacity of ${name}`}
              min={0.05}
              max={1}
              step={0.05}
              value={opacity}
              onInput={(event) => onChange(name, { opacity: event.currentTarget.valueAsNumber })}
            />
          ),
        },
        {
          title: "Colour",
          cell: ({ name, colour }) => (
            <input
              type="color"
              aria-label={`Colour of ${name}`}
              value={colour}
              onInput={(event) => onChange(name, { colour: event.currentTarget.value })}
            />
          ),
        },
      ]}
    />
  );
}
