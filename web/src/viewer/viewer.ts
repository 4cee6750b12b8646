import { AmbientLight, Color, DirectionalLight, Plane, Scene, Vector3, WebGLRenderer } from "three";
import { boundsOfAll } from "../mesh/triangles";
import { CoilDots } from "./coil_dots";
import { Gaze } from "./gaze";
import { Markers } from "./markers";
import { pick, type TreeMaker } from "./picking";
import { Pointing } from "./pointing";
import { RegionBoxes } from "./region_boxes";
import { Sharpness } from "./sharpness";
import { Shell } from "./shell";
import type { Clip, Marker, Probe, RegionBox, Surface } from "./surface";

export interface ViewerEvents {
  onProbe?: (probe: Probe | null) => void;
  onBox?: (number: number, box: RegionBox) => void;
  /** Without it search trees are made on the page itself, which stands still meanwhile. */
  makeTree?: TreeMaker;
}

/** Surfaces in 3D. Draws when something changed and never else; everything it shows is handed to it. */
export class Viewer {
  readonly gaze: Gaze;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly plane = new Plane(new Vector3(-1, 0, 0), 0);
  private readonly markers = new Markers();
  private readonly boxes = new RegionBoxes();
  private readonly coil = new CoilDots();
  private readonly sharpness: Sharpness;
  private readonly pointing: Pointing;
  private readonly sizes: ResizeObserver;
  private readonly makeTree: TreeMaker | undefined;
  private shells: Shell[] = [];
  private clip: Clip | null = null;
  private frame = 0;

  /** Throws where the browser has no WebGL 2. */
  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly events: ViewerEvents = {},
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true });
    this.renderer.localClippingEnabled = true;
    this.sharpness = new Sharpness(this.renderer, () => this.draw());
    // who waits for a tree with the pointer at rest is answered when it is there
    this.makeTree = events.makeTree && ((mesh) => events.makeTree!(mesh).finally(() => this.pointing.lookAgain()));
    this.gaze = new Gaze(canvas);
    this.gaze.onMove(() => {
      this.sharpness.moved();
      this.draw();
    });
    this.pointing = new Pointing(canvas, this.gaze, this.boxes, {
      onBox: (number, box) => events.onBox?.(number, box),
      onPlace: () => this.draw(),
      onAway: () => events.onProbe?.(null),
    });
    const lamp = new DirectionalLight("#ffffff", 2.2);
    lamp.position.set(0.4, 0.6, 1);
    this.gaze.camera.add(lamp);
    const held = [this.markers.group, this.boxes.group, this.coil.points];
    this.scene.add(new AmbientLight("#ffffff", 1.1), this.gaze.camera, ...held);
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(canvas.parentElement ?? canvas);
    this.setCoil(null);
    this.resize();
  }

  /** Surfaces from outside inwards. Those seen before keep what they have on the graphics card. */
  setSurfaces(surfaces: readonly Surface[]): void {
    const same =
      surfaces.length === this.shells.length && surfaces.every((one, i) => one.mesh === this.shells[i]!.surface.mesh);
    if (!same) this.replaceShells(surfaces);
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

  setMarkers(markers: readonly Marker[]): void {
    this.markers.set(markers);
    this.draw();
  }

  setBoxes(boxes: readonly RegionBox[], colour = "#0b6477"): void {
    this.boxes.set(boxes, colour);
    this.draw();
  }

  /** Places of a coil, x, y, z in mm one after the other. */
  setCoil(places: Float32Array | null): void {
    this.coil.set(places);
    this.draw();
  }

  setBackground(colour: string): void {
    this.scene.background = new Color(colour);
    this.draw();
  }

  async screenshot(): Promise<Blob | null> {
    this.sharpness.sharpen();
    this.render();
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  /** What is shown, at once, on a canvas that keeps it; for paper, where nothing is drawn later. */
  copyTo(canvas: HTMLCanvasElement, ground: string): void {
    const usual = this.scene.background;
    this.scene.background = new Color(ground);
    this.sharpness.sharpen();
    this.render();
    canvas.width = this.canvas.width;
    canvas.height = this.canvas.height;
    canvas.getContext("2d")?.drawImage(this.canvas, 0, 0);
    this.scene.background = usual;
    this.draw();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.sizes.disconnect();
    for (const one of [this.sharpness, this.pointing, this.gaze, ...this.shells]) one.dispose();
    for (const one of [this.markers, this.boxes, this.coil, this.renderer]) one.dispose();
  }

  private replaceShells(surfaces: readonly Surface[]): void {
    const first = this.shells.length === 0;
    for (const shell of this.shells) {
      this.scene.remove(shell.group);
      shell.dispose();
    }
    this.shells = surfaces.map((surface, order) => new Shell(surface, order, this.plane));
    for (const shell of this.shells) this.scene.add(shell.group);
    const other = surfaces.length > 0 && this.gaze.measure(boundsOfAll(surfaces.map((surface) => surface.mesh)));
    if (first || other) this.gaze.fit(); // what was known already is looked at from where we are
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

  private readonly render = (): void => {
    this.frame = 0;
    const { camera } = this.gaze;
    this.gaze.fitDepth();
    this.boxes.scaleTo(camera);
    this.markers.scaleTo(camera);
    const fromOutside = this.clip !== null && this.plane.distanceToPoint(camera.position) < 0;
    for (const shell of this.shells) shell.hideBehindFills(fromOutside);
    this.renderer.render(this.scene, camera);
    this.probe();
  };

  /** What lies under the pointer, where somebody asks. */
  private probe(): void {
    const place = this.events.onProbe ? this.pointing.takePlace() : null;
    if (!place) return;
    const plane = this.clip ? this.plane : null;
    this.events.onProbe!(pick(this.shells, this.gaze.camera, place.x, place.y, plane, this.makeTree));
  }
}
