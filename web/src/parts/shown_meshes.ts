import type { ResultReference } from "../api/types";

/** Which surfaces of a job can be shown, name -> reference: those it made, and those it was given where they are others. */
export function shownMeshes(
  results: Record<string, ResultReference> | null,
  inputs: Record<string, unknown> | null,
): Record<string, string> {
  const made = Object.entries(results ?? {}).filter(([, one]) => one.type === "model/stl");
  const shown = Object.fromEntries(made.map(([name, one]) => [name, new URL(one.href).pathname]));
  for (const [name, href] of Object.entries(referencesIn(inputs))) {
    if (made.length === 0) shown[name] = href;
    else if (!(name in shown) || shown.mesh) shown[`${name} before`] = href; // one surface into one: what became of it can be seen
  }
  return shown;
}

const HREF =
  /^(?:https?:\/\/[^/]+)?(\/v1\/(?:meshes\/[0-9a-f-]{36}|jobs\/[0-9a-f-]{36}\/results\/(?!package$)[A-Za-z0-9_.-]{1,64}))$/;

/** A tissue is called by its name, not by its place. */
function nameOf(value: unknown): string | null {
  const name = (value as { name?: unknown } | null)?.name;
  return typeof name === "string" && name ? name : null;
}

/** References anywhere in the inputs, named after where they stand. */
export function referencesIn(value: unknown, name = "surface"): Record<string, string> {
  if (typeof value === "string") {
    const path = HREF.exec(value)?.[1];
    return path ? { [name]: path } : {};
  }
  if (typeof value !== "object" || value === null) return {};
  // label volumes, fields and coils have no triangles
  const parts = Object.entries(value)
    .filter(([key]) => !["volume", "field", "coil"].includes(key))
    .map(([key, one]) => {
      if (Array.isArray(value))
        return referencesIn(one, nameOf(one) ?? (value.length > 1 ? `${name} ${Number(key) + 1}` : name));
      return referencesIn(one, key === "href" || nameOf(value) ? name : key);
    });
  return Object.assign({}, ...parts) as Record<string, string>;
}
