import { useEffect, useRef, useState } from "preact/hooks";
import { fetchTriangles } from "../api/meshes";
import { isPassing, messageOf } from "../api/server";
import type { ReadMesh } from "../mesh/worker";
import { useKeyCount } from "./key_count";

export interface LoadedTriangles {
  meshes: Record<string, ReadMesh>;
  loading: boolean;
  failure: string;
}

const NOTHING_YET: LoadedTriangles = { meshes: {}, loading: true, failure: "" };
const NOTHING: LoadedTriangles = { meshes: {}, loading: false, failure: "" };
const AGAIN_MS = 2000;

/** The triangles behind references, by name; what is there is there, the rest follows, also after the server was away. */
export function useTriangles(hrefs: Record<string, string>): LoadedTriangles {
  const key = JSON.stringify(hrefs);
  const [state, setState] = useState({ ...NOTHING_YET, key: "" });
  const newest = useRef(state);
  const [turn, setTurn] = useState(0);
  const keys = useKeyCount();
  useEffect(() => {
    let gone = false;
    let timer = 0;
    const wanted = Object.entries(JSON.parse(key) as Record<string, string>);
    const meshes = newest.current.key === key ? { ...newest.current.meshes } : {};
    const missing = wanted.filter(([name]) => !(name in meshes));
    const tell = (failure = "") => {
      if (gone) return;
      const loading = Object.keys(meshes).length < wanted.length;
      newest.current = { key, meshes: { ...meshes }, loading, failure };
      setState(newest.current);
    };
    if (newest.current.key !== key || missing.length > 0) tell();
    for (const [name, href] of missing) {
      fetchTriangles(href).then(
        (mesh) => {
          meshes[name] = mesh;
          tell();
        },
        (error) => {
          tell(`${name} cannot be shown: ${messageOf(error)}`);
          if (isPassing(error) && !gone) timer ||= window.setTimeout(() => setTurn((turn) => turn + 1), AGAIN_MS);
        },
      );
    }
    return () => {
      gone = true;
      clearTimeout(timer);
    };
  }, [key, turn, keys]);
  if (state.key === key) return state;
  return key === "{}" ? NOTHING : NOTHING_YET;
}
