import type { MeshInfo } from "../api/types";
import { Table } from "../parts/table";
import { NumberInput } from "./number_input";
import { type Choice, namedReferences, ReferenceInput } from "./references_input";
import { removeColumn } from "./remove_button";
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
        <Table
          rows={tissues}
          keyOf={(_, at) => at}
          columns={[
            {
              title: "Tissue",
              cell: (tissue, at) => (
                <input
                  class="layer-name"
                  aria-label={`Name of tissue ${at + 1}`}
                  value={tissue.name}
                  size={13}
                  onInput={(event) => change(at, { name: event.currentTarget.value })}
                />
              ),
            },
            {
              title: "Mesh",
              cell: (tissue, at) => (
                <ReferenceInput
                  id={`tissue-mesh-${at}`}
                  label={`Mesh of tissue ${at + 1}`}
                  choices={props.choices}
                  href={tissue.mesh.href}
                  optional={false}
                  onHref={(href) => choose(at, href)}
                />
              ),
            },
            {
              title: "Directly inside",
              cell: (tissue, at) => (
                <input
                  aria-label={`Surface that must be next around ${tissue.name}`}
                  value={tissue.inside ?? ""}
                  placeholder="whichever"
                  size={13}
                  onInput={(event) => change(at, { inside: event.currentTarget.value || undefined })}
                />
              ),
            },
            {
              title: "S/m",
              cell: (tissue, at) => (
                <NumberInput
                  label={`Conductivity of ${tissue.name} in S/m`}
                  value={tissue.conductivity_s_per_m}
                  placeholder="by name"
                  min={0}
                  onValue={(conductivity_s_per_m) => change(at, { conductivity_s_per_m })}
                />
              ),
            },
            removeColumn<Tissue>(
              (tissue) => `tissue ${tissue.name}`,
              (tissue) => onTissues(tissues.filter((one) => one !== tissue)),
            ),
          ]}
        />
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
