import type { Report, ResultReference } from "../api/types";

/** Which surfaces of a job can be shown, name -> reference: those it made; for one that only looked, those it looked at. */
export function shownMeshes(
  results: Record<string, ResultReference> | null,
  report: Report | null,
): Record<string, string> {
  const made = Object.entries(results ?? {}).filter(([, one]) => one.type === "model/stl");
  if (made.length > 0) return Object.fromEntries(made.map(([name, one]) => [name, new URL(one.href).pathname]));
  if (!report) return {};
  return inputsOf(report.parameters);
}

const HREF =
  /^(?:https?:\/\/[^/]+)?(\/v1\/(?:meshes\/[0-9a-f-]{36}|jobs\/[0-9a-f-]{36}\/results\/(?!package$)[A-Za-z0-9_.-]{1,64}))$/;

/** References anywhere in the parameters, named after where they stand. */
function inputsOf(value: unknown, name = "surface"): Record<string, string> {
  if (typeof value === "string") {
    const path = HREF.exec(value)?.[1];
    return path ? { [name]: path } : {};
  }
  if (typeof value !== "object" || value === null) return {};
  return Object.assign(
    {},
    ...Object.entries(value).map(([key, one]) =>
      inputsOf(one, key === "href" ? name : Array.isArray(value) ? `${name} ${Number(key) + 1}` : key),
    ),
  ) as Record<string, string>;
}
