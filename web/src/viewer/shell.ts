import {
  AlwaysStencilFunc,
  BackSide,
  BufferAttribute,
  BufferGeometry,
  DecrementWrapStencilOp,
  DoubleSide,
  EqualStencilFunc,
  FrontSide,
  Group,
  IncrementWrapStencilOp,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NotEqualStencilFunc,
  type Plane,
  PlaneGeometry,
  ReplaceStencilOp,
} from "three";
import { coloursOf } from "./colour_map";
import "./exact_clipping";
import { Outline } from "./outline";
import type { Axis, Field, Surface } from "./surface";

const FILLED = 0x80;
const COUNT = 0x7f;

/** One surface in the scene: the surface itself, and the filled face where the clipping plane cuts it.
 *
 * The fill is counted in the lower bits of the stencil buffer: back faces add one, front faces take one away, and where
 * something is left the plane lies inside. Shells are drawn from outside inwards, so the inner fill covers the outer. The
 * highest bit marks what is filled: from the side that is cut away nothing behind it is seen. Depth alone does not say so of
 * faces seen edge-on, whose depth within a pixel is anything. */
export class Shell {
  readonly group = new Group();
  readonly geometry = new BufferGeometry();
  readonly body: Mesh<BufferGeometry, MeshStandardMaterial>;
  surface: Surface;
  private readonly counters: Mesh[] = [];
  private readonly cap: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly outline: Outline;
  private unshared: BufferGeometry | null = null; // three corners to every face, for a colour per face

  constructor(surface: Surface, order: number, plane: Plane) {
    this.surface = surface;
    const { geometry } = this;
    geometry.setAttribute("position", new BufferAttribute(surface.mesh.positions, 3));
    geometry.setIndex(new BufferAttribute(surface.mesh.faces, 1));
    geometry.computeVertexNormals();
    this.body = new Mesh(geometry, new MeshStandardMaterial({ roughness: 0.75, metalness: 0, side: DoubleSide }));
    this.body.material.stencilWrite = true; // which turns the test on
    this.body.material.stencilWriteMask = 0;
    this.body.material.stencilFuncMask = FILLED;
    this.body.renderOrder = 500 - order; // what can be seen through is drawn last, from inside outwards
    this.group.add(this.body);
    for (const [side, operation] of [
      [BackSide, IncrementWrapStencilOp],
      [FrontSide, DecrementWrapStencilOp],
    ] as const) {
      const material = new MeshBasicMaterial({ side, depthWrite: false, depthTest: false, colorWrite: false });
      material.stencilWrite = true;
      material.stencilWriteMask = COUNT;
      material.stencilFunc = AlwaysStencilFunc;
      material.stencilFail = material.stencilZFail = material.stencilZPass = operation;
      material.clippingPlanes = [plane];
      const counter = new Mesh(geometry, material);
      counter.renderOrder = 10 * order + 1;
      this.counters.push(counter);
      this.group.add(counter);
    }
    // a little behind its plane, in which the outlines lie
    const fill = new MeshBasicMaterial({
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    fill.stencilWrite = true;
    fill.stencilRef = FILLED; // whose lower bits are 0
    fill.stencilFuncMask = COUNT;
    fill.stencilFunc = NotEqualStencilFunc;
    fill.stencilZFail = fill.stencilZPass = ReplaceStencilOp;
    this.cap = new Mesh(new PlaneGeometry(1, 1), fill);
    this.cap.renderOrder = 10 * order + 2;
    this.outline = new Outline(surface.mesh);
    this.outline.lines.renderOrder = 10 * order + 3;
    this.group.add(this.cap, this.outline.lines);
  }

  show(surface: Surface): void {
    this.surface = surface;
    const { material } = this.body;
    this.group.visible = surface.visible && surface.opacity > 0;
    material.opacity = surface.opacity;
    material.transparent = surface.opacity < 1;
    material.depthWrite = surface.opacity === 1;
    material.vertexColors = surface.field !== null;
    material.color.set(surface.field ? "#ffffff" : surface.colour);
    this.body.geometry = surface.field ? this.painted(surface.field) : this.geometry;
    material.needsUpdate = true;
    this.cap.material.color.set(surface.colour);
    this.outline.lines.material.color.set(surface.colour).multiplyScalar(0.45);
  }

  private painted({ values, low, high, map, each }: Field): BufferGeometry {
    const colours = coloursOf(values, low, high, map);
    if (each === "face") this.unshared ??= this.geometry.toNonIndexed();
    const geometry = each === "face" ? this.unshared! : this.geometry;
    geometry.setAttribute("color", new BufferAttribute(each === "face" ? threefold(colours) : colours, 3, true));
    return geometry;
  }

  /** `plane` is null where nothing is cut away. */
  cut(plane: Plane | null, axis: Axis, at: number, size: number, centre: readonly number[]): void {
    this.body.material.clippingPlanes = plane ? [plane] : [];
    const filled = plane !== null && this.surface.closed;
    for (const counter of this.counters) counter.visible = filled;
    this.cap.visible = filled;
    this.outline.lines.visible = plane !== null;
    if (!plane) return;
    this.cap.scale.setScalar(size);
    this.cap.rotation.set(axis === 1 ? Math.PI / 2 : 0, axis === 0 ? Math.PI / 2 : 0, 0);
    this.cap.position.set(centre[0]!, centre[1]!, centre[2]!).setComponent(axis, at);
    this.outline.cut(axis, at);
  }

  /** Whether fills hide all that lies behind them: they do from the side that is cut away. */
  hideBehindFills(hidden: boolean): void {
    this.body.material.stencilFunc = hidden ? EqualStencilFunc : AlwaysStencilFunc;
  }

  dispose(): void {
    this.geometry.dispose();
    this.unshared?.dispose();
    this.body.material.dispose();
    for (const counter of this.counters) (counter.material as MeshBasicMaterial).dispose();
    this.cap.geometry.dispose();
    this.cap.material.dispose();
    this.outline.dispose();
  }
}

/** The colour of a face for each of its corners. */
function threefold(colours: Uint8Array): Uint8Array {
  const corners = new Uint8Array(3 * colours.length);
  for (let f = 0; f < colours.length; f += 3) {
    const colour = colours.subarray(f, f + 3);
    for (let k = 0; k < 3; k++) corners.set(colour, 3 * f + 3 * k);
  }
  return corners;
}
