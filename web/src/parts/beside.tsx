import { useEffect, useMemo, useState } from "preact/hooks";
import { makeTree } from "../mesh/workshop";
import type { Clip, Marker, Surface } from "../viewer/surface";
import type { Viewer } from "../viewer/viewer";
import { ViewerPane } from "./viewer_pane";

/** A second view that moves with the first one, of a surface of one's choice. */
export function Beside(props: { surfaces: Surface[]; clip: Clip | null; markers: Marker[]; leader: Viewer | null }) {
  const { surfaces, leader } = props;
  const [name, setName] = useState(surfaces[1]?.name ?? "");
  const [follower, setFollower] = useState<Viewer | null>(null);
  const shown = useMemo(() => surfaces.filter((one) => one.name === name), [surfaces, name]);
  useEffect(() => {
    if (!leader || !follower) return;
    const follow = () => follower.gaze.setView(leader.gaze.view);
    follow();
    return leader.gaze.onMove(follow);
  }, [leader, follower]);
  return (
    <div class="stack">
      <ViewerPane
        makeTree={makeTree}
        label={`3D view of ${name}`}
        surfaces={shown}
        clip={props.clip}
        markers={props.markers}
        onViewer={setFollower}
        empty="Choose a surface."
      />
      <label class="row">
        Beside it
        <select value={name} onChange={(event) => setName(event.currentTarget.value)}>
          {surfaces.map((one) => (
            <option key={one.name}>{one.name}</option>
          ))}
        </select>
      </label>
    </div>
  );
}
