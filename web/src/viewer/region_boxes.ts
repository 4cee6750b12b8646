import {
  BoxGeometry,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  type PerspectiveCamera,
  Plane,
  Raycaster,
  SphereGeometry,
  type Vector2,
  Vector3,
} from "three";
import type { Axis, RegionBox } from "./surface";

/** Boxes people pull at: a handle in the middle of each of the six sides. */

interface Handle {
  box: number;
  axis: Axis;
  end: "min" | "max";
}

const LEAST_MM = 0.5;
const HANDLE_SHARE = 0.007; // of the distance to the camera
const OF_BOX = 0.06; // a handle larger than that hides a small box from afar

export class RegionBoxes {
  readonly group = new Group();
  private boxes: RegionBox[] = [];
  private handles: Mesh[] = [];
  private dragged: { handle: Handle; from: Vector3; start: number; plane: Plane } | null = null;

  set(boxes: readonly RegionBox[], colour: string): void {
    this.boxes = boxes.map((box) => ({ ...box, min: [...box.min], max: [...box.max] }));
    this.clear();
    boxes.forEach((box, number) => {
      const size = box.max.map((high, axis) => Math.max(high - box.min[axis]!, LEAST_MM)) as [number, number, number];
      const centre = box.max.map((high, axis) => (high + box.min[axis]!) / 2) as [number, number, number];
      const solid = new BoxGeometry(...size);
      const edges = new LineSegments(new EdgesGeometry(solid), new LineBasicMaterial({ color: colour }));
      const faint = new Mesh(
        solid,
        new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.1, depthWrite: false }),
      );
      // a box inside a body is seen through it, faintly
      const hidden = new LineSegments(
        edges.geometry,
        new LineBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: 0.45 }),
      );
      hidden.renderOrder = 990;
      hidden.position.set(...centre);
      edges.position.set(...centre);
      faint.position.set(...centre);
      faint.renderOrder = 900;
      this.group.add(edges, hidden, faint);
      if (box.fixed) return;
      for (const axis of [0, 1, 2] as const) {
        for (const end of ["min", "max"] as const) {
          const handle = new Mesh(
            new SphereGeometry(1, 16, 12),
            new MeshBasicMaterial({ color: colour, depthTest: false }),
          );
          handle.position.set(...centre).setComponent(axis, box[end][axis]);
          handle.renderOrder = 1000;
          handle.userData = { box: number, axis, end } satisfies Handle;
          this.handles.push(handle);
          this.group.add(handle);
        }
      }
    });
  }

  /** Handles keep their size on the screen, as long as their box is larger. */
  scaleTo(camera: PerspectiveCamera): void {
    for (const handle of this.handles) {
      const { min, max } = this.boxes[(handle.userData as Handle).box]!;
      const most = OF_BOX * Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
      handle.scale.setScalar(Math.min(HANDLE_SHARE * handle.position.distanceTo(camera.position), most));
    }
  }

  /** True if a handle was taken hold of. */
  grab(pointer: Vector2, camera: PerspectiveCamera): boolean {
    const caster = new Raycaster();
    caster.setFromCamera(pointer, camera);
    const hit = caster.intersectObjects(this.handles, false)[0];
    if (!hit) return false;
    const handle = hit.object.userData as Handle;
    const axis = new Vector3().setComponent(handle.axis, 1);
    const towards = camera.getWorldDirection(new Vector3());
    const normal = towards.addScaledVector(axis, -towards.dot(axis)).normalize(); // contains the axis, faces the camera
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal, hit.object.position);
    this.dragged = { handle, from: hit.point, start: this.boxes[handle.box]![handle.end][handle.axis], plane };
    return true;
  }

  /** The box as it is after the move, with its number; null if nothing is held. */
  drag(pointer: Vector2, camera: PerspectiveCamera): { number: number; box: RegionBox } | null {
    if (!this.dragged) return null;
    const { handle, from, start, plane } = this.dragged;
    const caster = new Raycaster();
    caster.setFromCamera(pointer, camera);
    const point = caster.ray.intersectPlane(plane, new Vector3());
    if (!point) return null;
    const { axis, end } = handle;
    const old = this.boxes[handle.box]!;
    const box: RegionBox = { ...old, min: [...old.min], max: [...old.max] };
    const wanted = start + point.getComponent(axis) - from.getComponent(axis);
    box[end][axis] =
      end === "min" ? Math.min(wanted, box.max[axis] - LEAST_MM) : Math.max(wanted, box.min[axis] + LEAST_MM);
    box[end][axis] = Math.round(box[end][axis] * 10) / 10;
    return { number: handle.box, box };
  }

  release(): boolean {
    const held = this.dragged !== null;
    this.dragged = null;
    return held;
  }

  dispose(): void {
    this.clear();
  }

  private clear(): void {
    for (const object of this.group.children) {
      const { geometry, material } = object as Mesh;
      geometry.dispose();
      (material as MeshBasicMaterial).dispose();
    }
    this.group.clear();
    this.handles = [];
  }
}
