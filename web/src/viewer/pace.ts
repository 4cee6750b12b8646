/** How sharp to draw while the view moves: full where the device keeps up, coarser where it does not, full again at rest. */

const SLOW_MS = 28; // between two frames: below 36 of them a second
const FAST_MS = 19;
const STEPS = [1, 0.75, 0.5] as const;
const SOME = 4; // frames that have to agree
const PAUSE_MS = 250; // a longer gap is no slow frame: nothing moved in between

export class Pace {
  private step = 0;
  private slow = 0;
  private fast = 0;
  private wanted = 4 * SOME;
  private last = Number.NEGATIVE_INFINITY;

  /** The share of the full resolution for a frame drawn now, in a movement. */
  moving(now: number): number {
    const gap = now - this.last;
    this.last = now;
    if (gap < PAUSE_MS) {
      this.slow = gap > SLOW_MS ? this.slow + 1 : 0;
      this.fast = gap < FAST_MS ? this.fast + 1 : 0;
      if (this.slow >= SOME) this.change(1);
      if (this.fast >= this.wanted) this.change(-1);
    }
    return STEPS[this.step]!;
  }

  private change(by: number): void {
    const before = this.step;
    this.step = Math.min(Math.max(before + by, 0), STEPS.length - 1);
    if (this.step > before) this.wanted *= 2; // what was too sharp is tried ever more rarely
    this.slow = this.fast = 0;
  }
}
