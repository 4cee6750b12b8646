import { Vector2 } from "three";
import type { Gaze } from "./gaze";
import { moveByKey } from "./keys";
import type { RegionBoxes } from "./region_boxes";
import type { RegionBox } from "./surface";

export interface PointingEvents {
  /** A side of a box was pulled. */
  onBox: (number: number, box: RegionBox) => void;
  /** There is another place to be looked under, or the same anew. */
  onPlace: () => void;
  onAway: () => void;
}

const MIDDLE = new Vector2(0, 0);

/** What pointer and keys ask besides turning the view: boxes are pulled by their handles, and places are looked under. */
export class Pointing {
  private asked: Vector2 | null = null; // in the next frame
  private resting: Vector2 | null = null;
  private reading = false; // by the keyboard, what is in the middle
  private readonly ended = new AbortController();

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly gaze: Gaze,
    private readonly boxes: RegionBoxes,
    private readonly events: PointingEvents,
  ) {
    const { signal } = this.ended;
    canvas.addEventListener("pointerdown", this.onDown, { capture: true, signal }); // before the camera's own
    canvas.addEventListener("pointermove", this.onMove, { signal });
    canvas.addEventListener("pointerup", () => this.boxes.release(), { signal });
    canvas.addEventListener("pointerleave", this.away, { signal });
    canvas.addEventListener("keydown", this.onKey, { signal });
  }

  /** The place to be looked under now, -1 to 1, y upwards; each is told once. */
  takePlace(): Vector2 | null {
    const place = this.asked;
    this.asked = null;
    return place;
  }

  /** Who waits with the pointer at rest is answered. */
  lookAgain(): void {
    this.asked = this.resting;
    if (this.asked) this.events.onPlace();
  }

  dispose(): void {
    this.ended.abort();
  }

  private placeOf(event: PointerEvent): Vector2 {
    const box = this.canvas.getBoundingClientRect();
    return new Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
  }

  private readonly onDown = (event: PointerEvent): void => {
    if (!this.boxes.grab(this.placeOf(event), this.gaze.camera)) return;
    event.stopImmediatePropagation(); // the handle moves, the camera does not
    this.canvas.setPointerCapture(event.pointerId);
  };

  private readonly onMove = (event: PointerEvent): void => {
    const moved = this.boxes.drag(this.placeOf(event), this.gaze.camera);
    if (moved) this.events.onBox(moved.number, moved.box);
    else if (event.buttons === 0) {
      this.reading = false;
      this.resting = this.placeOf(event);
      this.lookAgain();
    }
  };

  private readonly away = (): void => {
    this.asked = this.resting = null;
    this.events.onAway();
  };

  /** Enter reads what is in the middle, and goes on reading while keys move the view; Escape ends that. */
  private readonly onKey = (event: KeyboardEvent): void => {
    if (event.key === "Escape" && this.reading) {
      this.reading = false;
      this.away();
    } else if (event.key === "Enter") this.reading = true;
    else if (!moveByKey(this.gaze, event)) return;
    event.preventDefault();
    if (this.reading) this.resting = MIDDLE;
    this.lookAgain();
  };
}
