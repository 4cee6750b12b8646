import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  Group,
  Mesh,
  MeshBasicMaterial,
  Plane,
  Points,
  PointsMaterial,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { type Bounds, boundsOf } from "../mesh/triangles";
import { Gaze } from "./gaze";
import { moveByKey } from "./keys";
import { Pace } from "./pace";
import { pick, type TreeMaker } from "./picking";
import { RegionBoxes } from "./region_boxes";
import { Shell } from "./shell";
import type { Clip, Marker, Point, Probe, RegionBox, Surface } from "./surface";

/** Surfaces in 3D. Draws when something changed and never else; everything it shows is handed to it. */

const MARKER_COLOURS = { error: "#d0342c", warning: "#d99400", info: "#2d7dd2" };

const REST_MS = 180; // after the last movement
const COIL_DOT = 4; // pixels
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
  readonly gaze: Gaze;
  private readonly plane = new Plane(new Vector3(-1, 0, 0), 0);
  private readonly lamp = new DirectionalLight("#ffffff", 2.2);
  private readonly markers = new Group();
  private readonly ball = new SphereGeometry(1, 16, 12);
  private readonly boxes = new RegionBoxes();
  private readonly sizes: ResizeObserver;
  private shells: Shell[] = [];
  private clip: Clip | null = null;
  private frame = 0;
  private rest = 0;
  private readonly pace = new Pace();
  private pointer: Vector2 | null = null; // to be looked under in the next frame
  private hovering: Vector2 | null = null;
  private reading = false; // by the keyboard, what is in the middle
  private coil: Points<BufferGeometry, PointsMaterial> | null = null;
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
    this.gaze = new Gaze(canvas);
    this.scene.add(new AmbientLight("#ffffff", 1.1), this.gaze.camera, this.markers, this.boxes.group);
    this.gaze.camera.add(this.lamp);
    this.lamp.position.set(0.4, 0.6, 1);
    this.gaze.onMove(() => this.moved());
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
      const other = surfaces.length > 0 && this.gaze.measure(boundsOfAll(surfaces));
      if (first || other) this.gaze.fit(); // what was known already is looked at from where we are
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
    const { centre, radius } = this.gaze;
    for (const shell of this.shells) {
      shell.cut(clip ? this.plane : null, clip?.axis ?? 0, clip?.at ?? 0, 3 * radius, centre.toArray());
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

  /** Places of a coil, x, y, z one after the other; a dot each. */
  setCoil(places: Float32Array | null, color = "#b4541a"): void {
    if (this.coil) {
      this.scene.remove(this.coil);
      this.coil.geometry.dispose();
      this.coil.material.dispose();
    }
    this.coil = null;
    if (places) {
      const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(places, 3));
      this.coil = new Points(geometry, new PointsMaterial({ color, size: COIL_DOT, sizeAttenuation: false }));
      this.scene.add(this.coil);
    }
    this.draw();
  }

  setBackground(colour: string): void {
    this.scene.background = new Color(colour);
    this.draw();
  }

  async screenshot(): Promise<Blob | null> {
    this.renderer.setPixelRatio(this.fullRatio());
    this.render();
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  dispose(): void {
    clearTimeout(this.rest);
    this.sizes.disconnect();
    this.gaze.dispose();
    for (const shell of this.shells) shell.dispose();
    this.canvas.removeEventListener("pointerdown", this.onDown, { capture: true });
    this.canvas.removeEventListener("pointermove", this.onMove);
    this.canvas.removeEventListener("pointerup", this.onUp);
    this.canvas.removeEventListener("pointerleave", this.onLeave);
    this.canvas.removeEventListener("keydown", this.onKey);
    this.setCoil(null);
    cancelAnimationFrame(this.frame);
    this.renderer.dispose();
  }

  private resize(): void {
    const holder = this.canvas.parentElement ?? this.canvas;
    const [width, height] = [Math.max(holder.clientWidth, 1), Math.max(holder.clientHeight, 1)];
    this.renderer.setSize(width, height, false);
    this.gaze.resize(width, height);
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
    const { camera } = this.gaze;
    this.gaze.fitDepth();
    this.boxes.scaleTo(camera);
    for (const ball of this.markers.children) {
      ball.scale.setScalar(MARKER_SHARE * ball.position.distanceTo(camera.position));
    }
    const fromOutside = this.clip !== null && this.plane.distanceToPoint(camera.position) < 0;
    for (const shell of this.shells) shell.hideBehindFills(fromOutside);
    this.renderer.render(this.scene, camera);
    if (this.pointer && this.events.onProbe) {
      const { x, y } = this.pointer;
      const plane = this.clip ? this.plane : null;
      this.events.onProbe(pick(this.shells, camera, x, y, plane, this.makeTree));
      this.pointer = null;
    }
  };

  private lookAgain(): void {
    this.pointer = this.hovering;
    if (this.pointer) this.draw();
  }

  private placeOf(event: PointerEvent): Vector2 {
    const box = this.canvas.getBoundingClientRect();
    return new Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
  }

  private readonly onDown = (event: PointerEvent): void => {
    if (this.boxes.grab(this.placeOf(event), this.gaze.camera)) {
      event.stopImmediatePropagation(); // the handle moves, the camera does not
      this.canvas.setPointerCapture(event.pointerId);
    }
  };

  private readonly onMove = (event: PointerEvent): void => {
    const moved = this.boxes.drag(this.placeOf(event), this.gaze.camera);
    if (moved) this.events.onBox?.(moved.number, moved.box);
    else if (this.events.onProbe && event.buttons === 0) {
      this.reading = false;
      this.pointer = this.hovering = this.placeOf(event);
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

  /** Enter reads what is in the middle, and goes on reading while keys move the view; Escape ends that. */
  private readonly onKey = (event: KeyboardEvent): void => {
    if (event.key === "Escape" && this.reading) {
      this.reading = false;
      this.onLeave();
    } else if (event.key === "Enter") this.reading = true;
    else if (!moveByKey(this.gaze, event)) return;
    event.preventDefault();
    if (this.reading) this.hovering = new Vector2(0, 0);
    this.lookAgain();
  };
}

function boundsOfAll(surfaces: readonly Surface[]): Bounds {
  const all = surfaces.map((surface) => boundsOf(surface.mesh.positions));
  const end = (side: "min" | "max") =>
    [0, 1, 2].map((axis) => Math[side](...all.map((one) => one[side][axis]!))) as Point;
  return { min: end("min"), max: end("max") };
}
