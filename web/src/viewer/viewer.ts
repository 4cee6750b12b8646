import {
  AmbientLight,
  Color,
  DirectionalLight,
  Group,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  Plane,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { boundsOf } from "../mesh/triangles";
import { Pace } from "./pace";
import { pick, type TreeMaker } from "./picking";
import { RegionBoxes } from "./region_boxes";
import { Shell } from "./shell";
import type { Axis, Clip, Marker, Point, Probe, RegionBox, Surface } from "./surface";

/** Surfaces in 3D. Draws when something changed and never else; everything it shows is handed to it. */

const MARKER_COLOURS = { error: "#d0342c", warning: "#d99400", info: "#2d7dd2" };

const DEPTH = 1.5; // radii around the middle that are drawn: boxes may stick out
const NEAREST = 0.001; // of the radius
const REST_MS = 180; // after the last movement
const MARKER_SHARE = 0.005; // of the distance to the camera

export interface ViewerEvents {
  onProbe?: (probe: Probe | null) => void;
  onBox?: (number: number, box: RegionBox) => void;
  /** Without it search trees are made on the page itself, which stands still meanwhile. */
  makeTree?: TreeMaker;
}

export class Viewer {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 1, 10_000);
  private readonly plane = new Plane(new Vector3(-1, 0, 0), 0);
  private readonly lamp = new DirectionalLight("#ffffff", 2.2);
  private readonly markers = new Group();
  private readonly ball = new SphereGeometry(1, 16, 12);
  private readonly boxes = new RegionBoxes();
  private readonly listeners = new Set<() => void>();
  private readonly sizes: ResizeObserver;
  private controls: OrbitControls;
  private shells: Shell[] = [];
  private clip: Clip | null = null;
  private centre = new Vector3();
  private radius = 100;
  private up: Axis = 2;
  private frame = 0;
  private rest = 0;
  private readonly pace = new Pace();
  private pointer: PointerEvent | null = null; // to be looked under in the next frame
  private hovering: PointerEvent | null = null;
  private readonly makeTree: TreeMaker | undefined;

  /** Throws where the browser has no WebGL 2. */
  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly events: ViewerEvents = {},
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(this.fullRatio());
    // who waits for a tree with the pointer at rest is answered when it is there
    this.makeTree = events.makeTree && ((mesh) => events.makeTree!(mesh).finally(() => this.lookAgain()));
    this.scene.add(new AmbientLight("#ffffff", 1.1), this.camera, this.markers, this.boxes.group);
    this.camera.add(this.lamp);
    this.lamp.position.set(0.4, 0.6, 1);
    this.controls = this.newControls();
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(canvas.parentElement ?? canvas);
    canvas.addEventListener("pointerdown", this.onDown, { capture: true });
    canvas.addEventListener("pointermove", this.onMove);
    canvas.addEventListener("pointerup", this.onUp);
    canvas.addEventListener("pointerleave", this.onLeave);
    canvas.addEventListener("keydown", this.onKey);
    this.resize();
  }

  /** Surfaces from outside inwards. Those seen before keep what they have on the graphics card. */
  setSurfaces(surfaces: readonly Surface[]): void {
    const same =
      surfaces.length === this.shells.length && surfaces.every((one, i) => one.mesh === this.shells[i]!.surface.mesh);
    if (!same) {
      const first = this.shells.length === 0;
      for (const shell of this.shells) {
        this.scene.remove(shell.group);
        shell.dispose();
      }
      this.shells = surfaces.map((surface, order) => new Shell(surface, order, this.plane));
      for (const shell of this.shells) this.scene.add(shell.group);
      const before = [...this.centre.toArray(), this.radius];
      this.measure();
      const moved = [...this.centre.toArray(), this.radius].some(
        (value, i) => Math.abs(value - before[i]!) > 0.05 * this.radius,
      );
      if (first || moved) this.fit(); // another body; the same one in other clothes is looked at from where we are
    }
    surfaces.forEach((surface, i) => {
      this.shells[i]!.show(surface);
    });
    this.setClip(this.clip);
  }

  setClip(clip: Clip | null): void {
    this.clip = clip;
    if (clip) {
      const sign = clip.keep === "below" ? -1 : 1;
      this.plane.normal.set(0, 0, 0).setComponent(clip.axis, sign);
      this.plane.constant = -sign * clip.at;
    }
    const centre = this.centre.toArray();
    for (const shell of this.shells) {
      shell.cut(clip ? this.plane : null, clip?.axis ?? 0, clip?.at ?? 0, 3 * this.radius, centre);
    }
    this.draw();
  }

  /** Places, as large on the screen from near as from far. */
  setMarkers(markers: readonly Marker[]): void {
    for (const old of this.markers.children) ((old as Mesh).material as MeshBasicMaterial).dispose();
    this.markers.clear();
    for (const { point, severity } of markers) {
      const color = MARKER_COLOURS[severity];
      const ball = new Mesh(
        this.ball,
        new MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.85 }),
      );
      ball.position.set(...point);
      ball.renderOrder = 950;
      this.markers.add(ball);
    }
    this.draw();
  }

  setBoxes(boxes: readonly RegionBox[], colour = "#0b6477"): void {
    this.boxes.set(boxes, colour);
    this.draw();
  }

  setBackground(colour: string): void {
    this.scene.background = new Color(colour);
    this.draw();
  }

  /** All of it in view, from where the camera is. */
  fit(): void {
    const direction = new Vector3(1, 1, 1).setComponent(this.up, 0.25);
    this.lookFrom(direction.toArray());
  }

  /** All of it in view, from a direction (x, y, z). */
  lookFrom(direction: Point): void {
    const half = (this.camera.fov * Math.PI) / 360;
    const distance = (0.98 * this.radius) / Math.sin(Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect)));
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(new Vector3(...direction).normalize(), distance);
    this.controls.update();
    this.draw();
  }

  /** Close to one place, from beside it, outside the body. */
  flyTo(point: Point): void {
    const target = new Vector3(...point);
    const direction = new Vector3().subVectors(target, this.centre);
    direction.addScaledVector(this.camera.up, -direction.dot(this.camera.up));
    if (direction.length() < 0.02 * this.radius) direction.subVectors(this.camera.position, this.controls.target);
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction.normalize(), 0.25 * this.radius);
    this.controls.update();
    this.draw();
  }

  async screenshot(): Promise<Blob | null> {
    this.renderer.setPixelRatio(this.fullRatio());
    this.render();
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  /** For another viewer beside this one: where the camera is, and where it looks. */
  get view(): { position: Point; target: Point } {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }

  setView({ position, target }: { position: Point; target: Point }): void {
    this.camera.position.set(...position);
    this.controls.target.set(...target);
    this.controls.update();
    this.draw();
  }

  onView(listen: () => void): () => void {
    this.listeners.add(listen);
    return () => this.listeners.delete(listen);
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    clearTimeout(this.rest);
    this.sizes.disconnect();
    this.controls.dispose();
    for (const shell of this.shells) shell.dispose();
    this.canvas.removeEventListener("pointerdown", this.onDown, { capture: true });
    this.canvas.removeEventListener("pointermove", this.onMove);
    this.canvas.removeEventListener("pointerup", this.onUp);
    this.canvas.removeEventListener("pointerleave", this.onLeave);
    this.canvas.removeEventListener("keydown", this.onKey);
    this.renderer.dispose();
  }

  private newControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.addEventListener("change", () => {
      this.moved();
      for (const listen of this.listeners) listen();
    });
    controls.enableDamping = false;
    controls.minDistance = 0.5;
    return controls;
  }

  private measure(): void {
    const all = this.shells.map((shell) => boundsOf(shell.surface.mesh.positions));
    if (all.length === 0) return;
    const low = [0, 1, 2].map((axis) => Math.min(...all.map((one) => one.min[axis]!)));
    const high = [0, 1, 2].map((axis) => Math.max(...all.map((one) => one.max[axis]!)));
    const size = high.map((value, axis) => value - low[axis]!);
    this.centre.set((low[0]! + high[0]!) / 2, (low[1]! + high[1]!) / 2, (low[2]! + high[2]!) / 2);
    this.radius = Math.max(Math.hypot(size[0]!, size[1]!, size[2]!) / 2, 1e-3);
    // people stand along the longest side; what has none stands on z
    const longest = size.indexOf(Math.max(...size)) as Axis;
    const rest = size.filter((_, axis) => axis !== longest);
    this.up = size[longest]! > 1.4 * Math.max(...rest) ? longest : 2;
    this.camera.up.set(0, 0, 0).setComponent(this.up, 1);
    const target = this.controls.target.clone();
    this.controls.dispose();
    this.controls = this.newControls();
    this.controls.target.copy(target);
  }

  private resize(): void {
    const holder = this.canvas.parentElement ?? this.canvas;
    const [width, height] = [Math.max(holder.clientWidth, 1), Math.max(holder.clientHeight, 1)];
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private draw(): void {
    if (!this.frame) this.frame = requestAnimationFrame(this.render);
  }

  private fullRatio(): number {
    return Math.min(devicePixelRatio, 2);
  }

  /** Draw as sharp as the device keeps up with, and sharp when it rests. */
  private moved(): void {
    const ratio = this.fullRatio() * this.pace.moving(performance.now());
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    clearTimeout(this.rest);
    this.rest = window.setTimeout(this.sharpen, REST_MS);
    this.draw();
  }

  private readonly sharpen = (): void => {
    if (this.renderer.getPixelRatio() === this.fullRatio()) return;
    this.renderer.setPixelRatio(this.fullRatio());
    this.draw();
  };

  private readonly render = (): void => {
    this.frame = 0;
    this.fitDepth();
    this.boxes.scaleTo(this.camera);
    for (const ball of this.markers.children) {
      ball.scale.setScalar(MARKER_SHARE * ball.position.distanceTo(this.camera.position));
    }
    const fromOutside = this.clip !== null && this.plane.distanceToPoint(this.camera.position) < 0;
    for (const shell of this.shells) shell.hideBehindFills(fromOutside);
    this.renderer.render(this.scene, this.camera);
    if (this.pointer && this.events.onProbe) {
      const { x, y } = this.placeOf(this.pointer);
      const plane = this.clip ? this.plane : null;
      this.events.onProbe(pick(this.shells, this.camera, x, y, plane, this.makeTree));
      this.pointer = null;
    }
  };

  private lookAgain(): void {
    this.pointer = this.hovering;
    if (this.pointer) this.draw();
  }

  /** As little depth as holds all of it: surfaces half a millimetre apart must not flicker through each other. */
  private fitDepth(): void {
    const away = this.camera.position.distanceTo(this.centre);
    this.camera.near = Math.max(away - DEPTH * this.radius, NEAREST * this.radius);
    this.camera.far = away + DEPTH * this.radius;
    this.camera.updateProjectionMatrix();
  }

  private placeOf(event: PointerEvent): Vector2 {
    const box = this.canvas.getBoundingClientRect();
    return new Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
  }

  private readonly onDown = (event: PointerEvent): void => {
    if (this.boxes.grab(this.placeOf(event), this.camera)) {
      event.stopImmediatePropagation(); // the handle moves, the camera does not
      this.canvas.setPointerCapture(event.pointerId);
    }
  };

  private readonly onMove = (event: PointerEvent): void => {
    const moved = this.boxes.drag(this.placeOf(event), this.camera);
    if (moved) this.events.onBox?.(moved.number, moved.box);
    else if (this.events.onProbe && event.buttons === 0) {
      this.pointer = this.hovering = event;
      this.draw();
    }
  };

  private readonly onUp = (): void => {
    this.boxes.release();
  };

  private readonly onLeave = (): void => {
    this.pointer = this.hovering = null;
    this.events.onProbe?.(null);
  };

  private readonly onKey = (event: KeyboardEvent): void => {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-0.15, 0],
      ArrowRight: [0.15, 0],
      ArrowUp: [0, -0.15],
      ArrowDown: [0, 0.15],
    };
    const turn = turns[event.key];
    if (event.key === "+" || event.key === "=") this.zoom(0.85);
    else if (event.key === "-") this.zoom(1 / 0.85);
    else if (event.key === "Home") this.fit();
    else if (turn) this.orbit(...turn);
    else return;
    event.preventDefault();
  };

  private zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  private orbit(around: number, over: number): void {
    const arm = new Vector3().subVectors(this.camera.position, this.controls.target);
    arm.applyAxisAngle(this.camera.up, around);
    const side = new Vector3().crossVectors(this.camera.up, arm).normalize();
    const tilted = arm.clone().applyAxisAngle(side, over);
    if (Math.abs(tilted.clone().normalize().dot(this.camera.up)) < 0.98) arm.copy(tilted);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.draw();
  }
}
