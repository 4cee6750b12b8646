import { useEffect, useRef } from "preact/hooks";
import { colourAt } from "../viewer/colour_map";
import type { Field } from "../viewer/surface";
import { sayNumber } from "../words";

/** The colours of a field with their numbers; where they start and end can be typed. */
export function Legend({ field, onRange }: { field: Field; onRange: (low: number, high: number) => void }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const paper = canvas.current?.getContext("2d");
    if (!paper) return;
    for (let x = 0; x < 256; x++) {
      paper.fillStyle = `rgb(${colourAt(field.map, x / 255).join(" ")})`;
      paper.fillRect(x, 0, 1, 1);
    }
  }, [field.map]);
  const read = (event: Event) => (event.currentTarget as HTMLInputElement).valueAsNumber;
  return (
    <div class="legend stack">
      <canvas
        ref={canvas}
        width={256}
        height={1}
        role="img"
        aria-label={`${field.name} from ${sayNumber(field.low)} to ${sayNumber(field.high)} ${field.unit}`}
      />
      <div class="row spread">
        <input
          type="number"
          step="any"
          aria-label="Lowest value of the colours"
          value={Number(field.low.toPrecision(4))}
          onChange={(event) => !Number.isNaN(read(event)) && onRange(read(event), field.high)}
        />
        <span class="muted small">{field.unit || "no unit"}</span>
        <input
          type="number"
          step="any"
          aria-label="Highest value of the colours"
          value={Number(field.high.toPrecision(4))}
          onChange={(event) => !Number.isNaN(read(event)) && onRange(field.low, read(event))}
        />
      </div>
    </div>
  );
}
