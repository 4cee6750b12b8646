import type { MeshInfo } from "../api/types";
import { NumberInput } from "./number_input";
import { type Choice, namedReferences, ReferenceInput } from "./references_input";
import { RemoveButton, RemoveHeading } from "./remove_button";
import { freshName, type Tissue } from "./values";

/** Inner surfaces with their names, and what the server is not to guess about them. */
export function TissuesTable(props: {
  choices: readonly Choice[];
  meshes: readonly MeshInfo[];
  tissues: Tissue[];
  onTissues: (tissues: Tissue[]) => void;
}) {
  const { tissues, onTissues } = props;
  const names = tissues.map((tissue) => tissue.name);
  const change = (at: number, part: Partial<Tissue>) =>
    onTissues(tissues.map((tissue, i) => (i === at ? { ...tissue, ...part } : tissue)));
  // a tissue nobody has named yet is called as its mesh
  const choose = (at: number, href: string) => {
    const called = href ? Object.keys(namedReferences([href], props.meshes))[0]! : "";
    const unnamed = /^tissue(_\d+)?$/.test(names[at]!);
    change(at, { mesh: { href }, ...(unnamed && called ? { name: freshName(called, names) } : {}) });
  };
  return (
    <div class="stack">
      {tissues.length > 0 && (
        <div class="scroll-x">
          <table>
            <thead>
              <tr>
                <th>Tissue</th>
                <th>Mesh</th>
                <th>Directly inside</th>
                <th>S/m</th>
                <RemoveHeading />
              </tr>
            </thead>
            <tbody>
              {tissues.map((tissue, at) => (
                <tr key={at}>
                  <td>
                    <input
                      class="layer-name"
                      aria-label={`Name of tissue ${at + 1}`}
                      value={tissue.name}
                      size={13}
                      onInput={(event) => change(at, { name: event.currentTarget.value })}
                    />
                  </td>
                  <td>
                    <ReferenceInput
                      id={`tissue-mesh-${at}`}
                      label={`Mesh of tissue ${at + 1}`}
                      choices={props.choices}
                      href={tissue.mesh.href}
                      optional={false}
                      onHref={(href) => choose(at, href)}
                    />
                  </td>
                  <td>
                    <input
                      aria-label={`Surface that must be next around ${tissue.name}`}
                      value={tissue.inside ?? ""}
                      placeholder="whichever"
                      size={13}
                      onInput={(event) => change(at, { inside: event.currentTarget.value || undefined })}
                    />
                  </td>
                  <td>
                    <NumberInput
                      label={`Conductivity of ${tissue.name} in S/m`}
                      value={tissue.conductivity_s_per_m}
                      placeholder="by name"
                      min={0}
                      onValue={(conductivity_s_per_m) => change(at, { conductivity_s_per_m })}
                    />
                  </td>
                  <td>
                    <RemoveButton
                      what={`tissue ${tissue.name}`}
                      onRemove={() => onTissues(tissues.filter((_, i) => i !== at))}
                    />
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
      <div>
        <button
          type="button"
          disabled={tissues.length >= 48}
          onClick={() => onTissues([...tissues, { name: freshName("tissue", names), mesh: { href: "" } }])}
        >
          Add a tissue
        </button>
      </div>
    </div>
  );
}
