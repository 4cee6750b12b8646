import type { Job, MeshInfo } from "../api/types";
import { isSurface, sayContent, sayCount, sayWhen } from "../words";
import type { UploadKind } from "./schema_kind";
import type { Reference } from "./values";

/** Choices among what the server holds. Names are text, whatever is in them. */

export interface Choice {
  href: string;
  title: string;
}

export function meshChoices(meshes: readonly MeshInfo[]): Choice[] {
  const surfaces = meshes.filter(isSurface);
  const count = new Map<string, number>();
  for (const { name } of surfaces) count.set(name, (count.get(name) ?? 0) + 1);
  return surfaces.map((mesh) => ({
    href: `/v1/meshes/${mesh.id}`,
    title: `${mesh.name} (${sayCount(mesh.faces)} faces)${count.get(mesh.name)! > 1 ? `, ${sayWhen(mesh.created)}` : ""}`,
  }));
}

export function uploadChoices(meshes: readonly MeshInfo[], kind: UploadKind): Choice[] {
  return meshes
    .filter((mesh) => mesh[kind] !== undefined)
    .map((mesh) => ({ href: `/v1/meshes/${mesh.id}`, title: `${mesh.name} (${sayContent(mesh)})` }));
}

export function packageChoices(jobs: readonly Job[]): Choice[] {
  return jobs
    .filter((job) => !["validate", "graft", "detach", "fields"].includes(job.processID))
    .map((job) => ({
      href: `/v1/jobs/${job.jobID}/results/package`,
      title: `${job.processID}, ${new Date(job.created).toLocaleString("en-GB")}: ${job.summary ?? ""}`,
    }));
}

export function ReferenceInput(props: {
  id: string;
  label?: string | undefined;
  choices: readonly Choice[];
  href: string;
  optional: boolean;
  onHref: (href: string) => void;
}) {
  const { choices, href } = props;
  const known = choices.some((one) => one.href === href);
  return (
    <select
      id={props.id}
      aria-label={props.label}
      value={href}
      onChange={(event) => props.onHref(event.currentTarget.value)}
    >
      <option value="">{props.optional ? "None" : "Choose…"}</option>
      {href && !known && <option value={href}>{sayReference(href)}</option>}
      {choices.map((one) => (
        <option key={one.href} value={one.href}>
          {one.title}
        </option>
      ))}
    </select>
  );
}

export function ReferencesInput(props: {
  label: string;
  choices: readonly Choice[];
  chosen: readonly string[];
  onChosen: (hrefs: string[]) => void;
}) {
  const { chosen, onChosen } = props;
  const listed = props.choices.map((one) => one.href);
  const choices = [
    ...chosen.filter((href) => !listed.includes(href)).map((href) => ({ href, title: sayReference(href) })),
    ...props.choices,
  ];
  return (
    <fieldset class="choices">
      <legend class="hidden-label">{props.label}</legend>
      {choices.length === 0 && <p class="muted">Nothing was uploaded yet.</p>}
      {choices.map((one) => (
        <label key={one.href} class="row">
          <input
            type="checkbox"
            checked={chosen.includes(one.href)}
            onChange={(event) =>
              onChosen(event.currentTarget.checked ? [...chosen, one.href] : chosen.filter((href) => href !== one.href))
            }
          />
          {one.title}
        </label>
      ))}
    </fieldset>
  );
}

/** What is not in the list: an older upload, or what a job made. */
function sayReference(href: string): string {
  const [, job, output] = /^\/v1\/jobs\/([0-9a-f]{8})[^/]*\/results\/(.+)$/.exec(href) ?? [];
  return job ? `${output} of job ${job}` : `mesh ${href.split("/").pop()!.slice(0, 8)}`;
}

export function hrefOf(value: unknown): string {
  return (value as Reference | undefined)?.href ?? "";
}

/** Names as the server takes them, unlike each other, for surfaces that go in together. */
export function namedReferences(hrefs: readonly string[], meshes: readonly MeshInfo[]): Record<string, Reference> {
  const named: Record<string, Reference> = {};
  for (const href of hrefs) {
    const found = meshes.find((mesh) => href.endsWith(mesh.id))?.name ?? "mesh";
    const plain =
      found
        .replace(/[^A-Za-z0-9_-]+/g, "_")
        .replace(/^[^A-Za-z0-9]+/, "")
        .slice(0, 56) || "mesh";
    let name = plain;
    const taken = () => Object.keys(named).some((one) => one.toLowerCase() === name.toLowerCase());
    for (let number = 2; taken(); number++) name = `${plain}_${number}`;
    named[name] = { href };
  }
  return named;
}
