import { askJson } from "../api/server";
import type { ProcessSummary } from "../api/types";
import { PRESETS } from "../form/presets";
import { plain } from "../words";
import { Failure } from "./failure";
import { useLoaded } from "./loaded";

/** What is to be done: settings people ask for by name, or any process. */
export function ProcessChoice(props: {
  processId: string;
  description: string;
  preset: string;
  onChoose: (process: string, values: Record<string, unknown>, preset: string) => void;
}) {
  const { processId, preset, onChoose } = props;
  const catalogue = useLoaded("processes", (signal) =>
    askJson<{ processes: ProcessSummary[] }>("/v1/processes", { signal }),
  );
  return (
    <section class="card stack" aria-label="Presets">
      <h2>Start from</h2>
      {PRESETS.map((one) => (
        <button
          key={one.title}
          type="button"
          class="preset"
          aria-pressed={preset === one.title}
          onClick={() => onChoose(one.process, one.values, one.title)}
        >
          <span>
            <b>{one.title}</b>
            <br />
            <span class="small">{one.about}</span>
          </span>
        </button>
      ))}
      <div class="field">
        <label for="process">Process</label>
        <select id="process" value={processId} onChange={(event) => onChoose(event.currentTarget.value, {}, "")}>
          {catalogue.value?.processes.map((one) => (
            <option key={one.id} value={one.id}>
              {one.title}
            </option>
          ))}
        </select>
        <p class="muted small">{plain(props.description)}</p>
      </div>
      {catalogue.error ? <Failure error={catalogue.error} again={catalogue.again} /> : null}
    </section>
  );
}
