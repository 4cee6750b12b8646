import { Group, Mesh, MeshBasicMaterial, type PerspectiveCamera, SphereGeometry } from "three";
import type { Marker } from "./surface";

const COLOURS = { error: "#d0342c", warning: "#d99400", info: "#2d7dd2" };
const SHARE = 0.005; // of the distance to the camera
const DRAWN_LATE = 950; // over the surfaces

/** Places, as large on the screen from near as from far. */
export class Markers {
  readonly group = new Group();
  private readonly ball = new SphereGeometry(1, 16, 12);

  set(markers: readonly Marker[]): void {
    this.clear();
    for (const { point, severity } of markers) {
      const color = COLOURS[severity];
      const ball = new Mesh(
        this.ball,
        new MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.85 }),
      );
      ball.position.set(...point);
      ball.renderOrder = DRAWN_LATE;
      this.group.add(ball);
    }
  }

  scaleTo(camera: PerspectiveCamera): void {
    for (const ball of this.group.children) ball.scale.setScalar(SHARE * ball.position.distanceTo(camera.position));
  }

  dispose(): void {
    this.clear();
    this.ball.dispose();
  }

  private clear(): void {
    for (const ball of this.group.children) ((ball as Mesh).material as MeshBasicMaterial).dispose();
    this.group.clear();
  }
}
