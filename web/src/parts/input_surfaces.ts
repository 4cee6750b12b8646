import { useMemo } from "preact/hooks";
import { getResults } from "../api/jobs";
import { hrefOf } from "../form/references_input";
import { tissueColours } from "../tissues";
import type { Surface } from "../viewer/surface";
import { useLoaded } from "./loaded";
import { outsideIn } from "./outside_in";
import { referencesIn, shownMeshes } from "./shown_meshes";
import { type LoadedTriangles, useTriangles } from "./triangles_of";

const SEEN_THROUGH = 0.35; // what lies around another surface

export interface InputSurfaces {
  /** From outside inwards. */
  surfaces: Surface[];
  triangles: LoadedTriangles;
  /** Where the first surface that was chosen comes from; empty if none was. */
  href: string;
  /** Names of what the chosen package holds; null without one. */
  packed: string[] | null;
}

/** The surfaces a job is to work on, as far as its inputs name them: one by one, or all of a package. */
export function useInputSurfaces(inputs: Record<string, unknown>): InputSurfaces {
  const given = referencesIn(inputs);
  const packed = hrefOf(inputs.package);
  const contents = useLoaded(`results ${packed}`, async (signal) =>
    packed ? shownMeshes(await getResults(packed.split("/")[3]!, signal), null) : {},
  );
  const triangles = useTriangles({ ...contents.value, ...given });
  const names = outsideIn(triangles.meshes);
  const surfaces = useMemo<Surface[]>(() => {
    const colours = names.length === 1 ? { [names[0]!]: tissueColours(["skin"]).skin! } : tissueColours(names);
    return names.map((name, place) => ({
      name,
      mesh: triangles.meshes[name]!.shown,
      colour: colours[name]!,
      visible: true,
      opacity: place < names.length - 1 ? SEEN_THROUGH : 1,
      closed: triangles.meshes[name]!.closed,
      field: null,
    }));
  }, [triangles.meshes, names.join("\n")]);
  return {
    surfaces,
    triangles,
    href: Object.values(given)[0] ?? "",
    packed: packed ? Object.keys(contents.value ?? {}) : null,
  };
}
