import {
  AlwaysStencilFunc,
  BackSide,
  BufferAttribute,
  BufferGeometry,
  DecrementWrapStencilOp,
  DoubleSide,
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
  type WebGLRenderer,
} from "three";
import { coloursOf } from "./colour_map";
import { Outline } from "./outline";
import type { Axis, Surface } from "./surface";

/** One surface in the scene: the surface itself, and the filled face where the clipping plane cuts it.
 *
 * The fill is counted in the stencil buffer: back faces add one, front faces take one away, and where something is left
 * the plane lies inside. Shells are drawn from outside inwards, so the inner fill covers the outer. */
export class Shell {
  readonly group = new Group();
  readonly body: Mesh<BufferGeometry, MeshStandardMaterial>;
  surface: Surface;
  private readonly counters: Mesh[] = [];
  private readonly cap: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly outline: Outline;

  constructor(surface: Surface, order: number, plane: Plane, renderer: WebGLRenderer) {
    this.surface = surface;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(surface.mesh.positions, 3));
    geometry.setIndex(new BufferAttribute(surface.mesh.faces, 1));
    geometry.computeVertexNormals();
    this.body = new Mesh(geometry, new MeshStandardMaterial({ roughness: 0.75, metalness: 0, side: DoubleSide }));
    this.body.renderOrder = 500 - order; // what can be seen through is drawn last, from inside outwards
    this.group.add(this.body);
    for (const [side, operation] of [
      [BackSide, IncrementWrapStencilOp],
      [FrontSide, DecrementWrapStencilOp],
    ] as const) {
      const material = new MeshBasicMaterial({ side, depthWrite: false, depthTest: false, colorWrite: false });
      material.stencilWrite = true;
      material.stencilFunc = AlwaysStencilFunc;
      material.stencilFail = material.stencilZFail = material.stencilZPass = operation;
      material.clippingPlanes = [plane];
      const counter = new Mesh(geometry, material);
      counter.renderOrder = 10 * order + 1;
      this.counters.push(counter);
      this.group.add(counter);
    }
    const fill = new MeshBasicMaterial({ side: DoubleSide });
    fill.stencilWrite = true;
    fill.stencilRef = 0;
    fill.stencilFunc = NotEqualStencilFunc;
    fill.stencilFail = fill.stencilZFail = fill.stencilZPass = ReplaceStencilOp;
    this.cap = new Mesh(new PlaneGeometry(1, 1), fill);
    this.cap.renderOrder = 10 * order + 2;
    this.cap.onAfterRender = () => renderer.clearStencil();
    this.outline = new Outline(surface.mesh);
    this.outline.lines.renderOrder = 10 * order + 3;
    this.group.add(this.cap, this.outline.lines);
  }

  show(surface: Surface): void {
    this.surface = surface;
    const { material, geometry } = this.body;
    this.group.visible = surface.visible && surface.opacity > 0;
    material.opacity = surface.opacity;
    material.transparent = surface.opacity < 1;
    material.depthWrite = surface.opacity === 1;
    material.vertexColors = surface.field !== null;
    material.color.set(surface.field ? "#ffffff" : surface.colour);
    if (surface.field) {
      const { values, low, high, map } = surface.field;
      geometry.setAttribute("color", new BufferAttribute(coloursOf(values, low, high, map), 3, true));
    } else {
      geometry.deleteAttribute("color");
    }
    material.needsUpdate = true;
    this.cap.material.color.set(surface.colour);
    this.outline.lines.material.color.set(surface.colour).multiplyScalar(0.45);
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

  dispose(): void {
    this.body.geometry.dispose();
    this.body.material.dispose();
    for (const counter of this.counters) (counter.material as MeshBasicMaterial).dispose();
    this.cap.geometry.dispose();
    this.cap.material.dispose();
    this.outline.dispose();
  }
}
