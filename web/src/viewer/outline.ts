import { BufferAttribute, BufferGeometry, DynamicDrawUsage, LineBasicMaterial, LineSegments } from "three";
import { cutAcross, Segments } from "../mesh/section";
import { Slabs } from "../mesh/slabs";
import type { Triangles } from "../mesh/triangles";
import type { Axis } from "./surface";

/** The line along which a plane cuts one surface. It follows a plane that is dragged: no search through all faces, no new memory. */
export class Outline {
  readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly segments = new Segments();
  private readonly slabs: (Slabs | null)[] = [null, null, null]; // made when first cut across that axis
  private attribute: BufferAttribute;

  constructor(private readonly mesh: Triangles) {
    this.attribute = this.newAttribute();
    this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.lines.geometry.setAttribute("position", this.attribute);
    this.lines.frustumCulled = false;
  }

  cut(axis: Axis, at: number): void {
    const { geometry } = this.lines;
    const slabs = this.slabs[axis] ?? new Slabs(this.mesh, axis);
    this.slabs[axis] = slabs;
    cutAcross(this.mesh, slabs, axis, at, this.segments);
    if (this.attribute.array !== this.segments.ends) {
      geometry.dispose(); // the larger one gets a buffer of its own on the graphics card
      this.attribute = this.newAttribute();
      geometry.setAttribute("position", this.attribute);
    }
    this.attribute.clearUpdateRanges();
    this.attribute.addUpdateRange(0, this.segments.length);
    this.attribute.needsUpdate = true;
    geometry.setDrawRange(0, this.segments.length / 3);
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }

  private newAttribute(): BufferAttribute {
    const attribute = new BufferAttribute(this.segments.ends, 3);
    attribute.setUsage(DynamicDrawUsage);
    return attribute;
  }
}
