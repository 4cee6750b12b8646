import type { WebGLRenderer } from "three";
import { Pace } from "./pace";

const REST_MS = 180; // after the last movement
const MOST = 2; // pixels of the screen beside each other that nobody tells apart

/** Draws as sharp as the device keeps up with while the view moves, and sharp when it rests. */
export class Sharpness {
  private readonly pace = new Pace();
  private rest = 0;

  constructor(
    private readonly renderer: WebGLRenderer,
    private readonly draw: () => void,
  ) {
    this.sharpen();
  }

  moved(): void {
    this.take(this.full * this.pace.moving(performance.now()));
    clearTimeout(this.rest);
    this.rest = window.setTimeout(() => this.sharpen() && this.draw(), REST_MS);
  }

  /** True if it was coarser. */
  sharpen(): boolean {
    return this.take(this.full);
  }

  dispose(): void {
    clearTimeout(this.rest);
  }

  private get full(): number {
    return Math.min(devicePixelRatio, MOST);
  }

  private take(ratio: number): boolean {
    if (ratio === this.renderer.getPixelRatio()) return false;
    this.renderer.setPixelRatio(ratio);
    return true;
  }
}
