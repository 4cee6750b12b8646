import { useMemo } from "preact/hooks";
import { fetchField } from "../api/meshes";
import { messageOf } from "../api/server";
import type { Report, ResultReference } from "../api/types";
import { useLoaded } from "./loaded";
import { shownMeshes } from "./shown_meshes";
import { type LoadedTriangles, useTriangles } from "./triangles_of";

const NONE = {};

/** The surfaces of a job: those it made or was given, or those of a solver's field with its numbers. */
export function useShownSurfaces(
  results: Record<string, ResultReference> | null,
  inputs: Record<string, unknown> | null,
  report: Report | null,
): LoadedTriangles {
  const counts = Object.fromEntries(Object.entries(report?.fields ?? {}).map(([name, one]) => [name, one.faces]));
  const solved = results?.msh && report?.process === "fields" ? new URL(results.msh.href).pathname : "";
  const field = useLoaded(`field ${solved}`, async (signal) => (solved ? fetchField(solved, counts, signal) : null));
  const hrefs = useMemo(
    () => (results && inputs && !solved ? shownMeshes(results, inputs) : {}),
    [results, inputs, solved],
  );
  const triangles = useTriangles(hrefs);
  if (!solved) return triangles;
  return {
    meshes: field.value ?? NONE,
    loading: field.loading,
    failure: field.error ? `The field cannot be shown: ${messageOf(field.error)}` : "",
  };
}
