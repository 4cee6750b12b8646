import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Bounds } from "../mesh/triangles";
import type { Axis, Point } from "./surface";

const FIELD_OF_VIEW_DEG = 32;
const DEPTH = 1.5; // radii around the middle that are drawn: boxes may stick out
const NEAREST = 0.001; // of the radius
const CLOSE = 0.25; // how far from a place it is looked at, in radii
const STEEPEST = 0.98; // cosine between the direction of view and upwards
const OTHER = 0.05; // a body moved or grown by more than this share of its radius is another one

/** Where the camera is, and what it looks at: turned by the mouse, moved by commands. */
export class Gaze {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 1, 10_000);
  /** Of all surfaces. */
  readonly centre = new Vector3();
  radius = 100;
  private up: Axis = 2;
  private controls: OrbitControls;
  private readonly listeners = new Set<() => void>();

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.controls = this.newControls();
  }

  /** Called whenever the camera moved; returns how to end that. */
  onMove(listen: () => void): () => void {
    this.listeners.add(listen);
    return () => this.listeners.delete(listen);
  }

  /** What there is to be seen. True if it is another body, not the same in other clothes. */
  measure({ min, max }: Bounds): boolean {
    const before = [...this.centre.toArray(), this.radius];
    const size = max.map((high, axis) => high - min[axis]!) as Point;
    this.centre.set((min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2);
    this.radius = Math.max(Math.hypot(...size) / 2, 1e-3);
    // people stand along the longest side; what has none stands on z
    const longest = size.indexOf(Math.max(...size)) as Axis;
    const rest = size.filter((_, axis) => axis !== longest);
    this.up = size[longest] > 1.4 * Math.max(...rest) ? longest : 2;
    this.camera.up.set(0, 0, 0).setComponent(this.up, 1);
    const target = this.controls.target.clone();
    this.controls.dispose(); // it knows the upward direction of its beginning alone
    this.controls = this.newControls();
    this.controls.target.copy(target);
    return [...this.centre.toArray(), this.radius].some(
      (value, i) => Math.abs(value - before[i]!) > OTHER * this.radius,
    );
  }

  /** All of it in view, from the side a little above. */
  fit(): void {
    this.lookFrom(new Vector3(1, 1, 1).setComponent(this.up, 0.25).toArray());
  }

  /** All of it in view, from a direction (x, y, z). */
  lookFrom(direction: Point): void {
    const half = (this.camera.fov * Math.PI) / 360;
    const distance = (0.98 * this.radius) / Math.sin(Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect)));
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(new Vector3(...direction).normalize(), distance);
    this.controls.update();
  }

  /** Close to one place, from beside it, outside the body. */
  flyTo(point: Point): void {
    const target = new Vector3(...point);
    const direction = new Vector3().subVectors(target, this.centre);
    direction.addScaledVector(this.camera.up, -direction.dot(this.camera.up));
    if (direction.length() < 0.02 * this.radius) direction.copy(this.arm());
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction.normalize(), CLOSE * this.radius);
    this.controls.update();
  }

  /** For another view beside this one: where the camera is, and where it looks. */
  get view(): { position: Point; target: Point } {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }

  setView({ position, target }: { position: Point; target: Point }): void {
    this.camera.position.set(...position);
    this.controls.target.set(...target);
    this.controls.update();
  }

  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }

  /** Turn around what is looked at, by radians: around the upward direction, and over it. */
  orbit(around: number, over: number): void {
    const arm = this.arm().applyAxisAngle(this.camera.up, around);
    const side = new Vector3().crossVectors(this.camera.up, arm).normalize();
    const tilted = arm.clone().applyAxisAngle(side, over);
    if (Math.abs(tilted.clone().normalize().dot(this.camera.up)) < STEEPEST) arm.copy(tilted);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
  }

  /** Move sideways and upwards by shares of the distance to what is looked at. */
  pan(right: number, upwards: number): void {
    const away = this.arm().length();
    const step = new Vector3(right * away, upwards * away, 0).applyQuaternion(this.camera.quaternion);
    this.controls.target.add(step);
    this.camera.position.add(step);
    this.controls.update();
  }

  resize(width: number, height: number): void {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** As little depth as holds all of it: surfaces half a millimetre apart must not flicker through each other. */
  fitDepth(): void {
    const away = this.camera.position.distanceTo(this.centre);
    this.camera.near = Math.max(away - DEPTH * this.radius, NEAREST * this.radius);
    this.camera.far = away + DEPTH * this.radius;
    this.camera.updateProjectionMatrix();
  }

  dispose(): void {
    this.controls.dispose();
  }

  private arm(): Vector3 {
    return new Vector3().subVectors(this.camera.position, this.controls.target);
  }

  private newControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.addEventListener("change", () => {
      for (const listen of this.listeners) listen();
    });
    controls.enableDamping = false;
    controls.minDistance = 0.5;
    return controls;
  }
}
