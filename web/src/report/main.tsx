import { render } from "preact";
import { messageOf } from "../api/server";
import { readScene, type SceneAbout } from "../mesh/scene";
import { findPlaces } from "./places";
import { SceneView } from "./scene_view";

/** What a report runs: its surfaces in 3D, once they come into sight. It asks nobody for anything. */

const textOf = (id: string): string => document.getElementById(id)?.textContent ?? "";

async function show(stage: HTMLElement): Promise<void> {
  try {
    const about = JSON.parse(textOf("scene-about")) as SceneAbout;
    const meshes = await readScene(about, textOf("scene-data"));
    stage.replaceChildren();
    render(<SceneView about={about} meshes={meshes} places={findPlaces(document)} />, stage);
  } catch (error) {
    stage.textContent = `The surfaces cannot be shown: ${messageOf(error)} The figures below need no 3D.`;
  }
}

const REST_MS = 2000; // of the page before what is out of sight is unpacked, too: it may be printed

const stage = document.getElementById("scene-stage");
if (stage) {
  stage.textContent = "The surfaces are unpacked when they come into sight…";
  const unpack = () => {
    watch.disconnect();
    clearTimeout(rest);
    void show(stage);
  };
  const watch = new IntersectionObserver(
    (entries) => {
      if (entries.some((entry) => entry.isIntersecting)) unpack();
    },
    { rootMargin: "200px" },
  );
  const rest = setTimeout(unpack, REST_MS);
  watch.observe(stage);
}
