import type { Gaze } from "./gaze";

const TURN = 0.15; // radians
const STEP = 0.04; // of the distance to what is looked at
const CLOSER = 0.85;
const ARROWS: Record<string, readonly [right: number, up: number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** What a key does to the view: arrows turn, with Shift they move, plus and minus zoom, Home shows all. False: none of these. */
export function moveByKey(gaze: Gaze, event: KeyboardEvent): boolean {
  const [right, up] = ARROWS[event.key] ?? [0, 0];
  if (event.ctrlKey || event.metaKey || event.altKey) return false; // the browser's own
  if (right !== 0 || up !== 0) {
    if (event.shiftKey) gaze.pan(STEP * right, STEP * up);
    else gaze.orbit(TURN * right, -TURN * up);
  } else if (event.key === "+" || event.key === "=") gaze.zoom(CLOSER);
  else if (event.key === "-") gaze.zoom(1 / CLOSER);
  else if (event.key === "Home") gaze.fit();
  else return false;
  return true;
}
