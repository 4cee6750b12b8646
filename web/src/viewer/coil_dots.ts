import { BufferAttribute, BufferGeometry, Points, PointsMaterial } from "three";

const COLOUR = "#b4541a";
const PIXELS = 4;

/** Places of a coil, a dot each. */
export class CoilDots {
  readonly points = new Points(
    new BufferGeometry(),
    new PointsMaterial({ color: COLOUR, size: PIXELS, sizeAttenuation: false }),
  );

  /** x, y, z in mm one after the other; null: no coil. */
  set(places: Float32Array | null): void {
    this.points.visible = places !== null;
    if (!places) return;
    this.points.geometry.dispose();
    this.points.geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(places, 3));
  }

  dispose(): void {
    this.points.geometry.dispose();
    this.points.material.dispose();
  }
}
