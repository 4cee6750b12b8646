import { useEffect, useState } from "preact/hooks";
import { fetchTriangles } from "../api/meshes";
import { messageOf } from "../api/server";
import type { ReadMesh } from "../mesh/worker";

export interface LoadedTriangles {
  meshes: Record<string, ReadMesh>;
  loading: boolean;
  failure: string;
}

/** The triangles behind references, by name; what is there is there, the rest follows. */
export function useTriangles(hrefs: Record<string, string>): LoadedTriangles {
  const key = JSON.stringify(hrefs);
  const [state, setState] = useState<LoadedTriangles & { key: string }>({
    key: "",
    meshes: {},
    loading: true,
    failure: "",
  });
  useEffect(() => {
    let gone = false;
    const wanted = Object.entries(JSON.parse(key) as Record<string, string>);
    const meshes: Record<string, ReadMesh> = {};
    const tell = (failure = "") => {
      if (!gone) setState({ key, meshes: { ...meshes }, loading: Object.keys(meshes).length < wanted.length, failure });
    };
    tell();
    for (const [name, href] of wanted) {
      fetchTriangles(href).then(
        (mesh) => {
          meshes[name] = mesh;
          tell();
        },
        (error) => tell(`${name} cannot be shown: ${messageOf(error)}`),
      );
    }
    return () => {
      gone = true;
    };
  }, [key]);
  return state.key === key ? state : { meshes: {}, loading: key !== "{}", failure: "" };
}
