import { useEffect, useState } from "preact/hooks";
import type { Bounds } from "../mesh/triangles";
import { AXES, type Point } from "../viewer/surface";
import { NumberInput } from "./number_input";
import { isRigid, ORIGIN, type Placement, placementOf, readPlacement, type Stand, standOf } from "./placement";

const PARTS: readonly (readonly [keyof Stand, string])[] = [
  ["position", "Position in mm"],
  ["towards", "Direction into the head"],
  ["handle", "Direction of the handle"],
];

/** Where a coil stands, said by its position and two directions, or by its matrix, which can be pasted into any of its cells. */
export function PlacementInput(props: {
  id: string;
  value: Placement | undefined;
  bounds: Bounds | null;
  onValue: (placement: Placement | undefined) => void;
}) {
  const { id, value, bounds } = props;
  const [byMatrix, setByMatrix] = useState(value !== undefined && !isRigid(value));
  const [stand, setStand] = useState<Stand>(value ? standOf(value) : ORIGIN);
  const [wrong, setWrong] = useState("");
  const shown = value ?? placementOf(stand)!;
  // what came from elsewhere is taken over; what is being typed stays as it is typed
  useEffect(() => {
    if (value && JSON.stringify(value) !== JSON.stringify(placementOf(stand))) setStand(standOf(value));
  }, [value]);
  const stands = (next: Stand) => {
    setStand(next);
    const placement = placementOf(next);
    setWrong(placement ? "" : "The two directions must be two: neither nothing, nor one the other.");
    if (placement) props.onValue(placement);
  };
  const place = (placement: Placement) => {
    setWrong(isRigid(placement) ? "" : "A coil is turned and shifted alone: no scale, no mirror, last row 0 0 0 1.");
    props.onValue(placement);
  };
  const paste = (event: ClipboardEvent) => {
    const found = readPlacement(event.clipboardData?.getData("text") ?? "");
    if (!found) return; // a single number goes where it was pasted
    event.preventDefault();
    place(found);
  };
  return (
    <fieldset class="stack" aria-label="Placement of the coil" onPaste={paste}>
      <div class="row">
        {[false, true].map((matrix) => (
          <label key={String(matrix)} class="row">
            <input type="radio" name={id} checked={byMatrix === matrix} onChange={() => setByMatrix(matrix)} />
            {matrix ? "As a matrix" : "By position and directions"}
          </label>
        ))}
        {bounds && (
          <button type="button" onClick={() => stands(above(bounds))}>
            On top of the head
          </button>
        )}
      </div>
      {byMatrix ? (
        <table class="matrix">
          <tbody>
            {shown.map((row, i) => (
              <tr key={i}>
                {row.map((number, j) => (
                  <td key={j}>
                    <NumberInput
                      label={`Placement: row ${i + 1}, column ${j + 1}`}
                      value={number}
                      onValue={(typed) =>
                        typed !== undefined && place(shown.map((one, k) => (k === i ? one.with(j, typed) : one)))
                      }
                    />
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      ) : (
        PARTS.map(([part, title]) => (
          <div key={part} class="row small">
            <span class="part">{title}</span>
            {AXES.map((axis, k) => (
              <NumberInput
                key={axis}
                label={`${title}: ${axis}`}
                value={stand[part][k]}
                onValue={(typed) =>
                  typed !== undefined && stands({ ...stand, [part]: stand[part].with(k, typed) as Point })
                }
              />
            ))}
          </div>
        ))
      )}
      <p class="muted small">
        The coil's z axis points into the head and its y axis along the handle, as SimNIBS has it. Sixteen numbers can
        be pasted anywhere here.
      </p>
      {wrong && (
        <p class="note bad small" role="alert">
          {wrong}
        </p>
      )}
    </fieldset>
  );
}

/** In the middle above the surfaces, facing down, handle to the back. */
function above({ min, max }: Bounds): Stand {
  const middle = (axis: 0 | 1) => Math.round(10 * ((min[axis] + max[axis]) / 2)) / 10;
  return { position: [middle(0), middle(1), Math.ceil(max[2]) + 5], towards: [0, 0, -1], handle: [0, -1, 0] };
}
