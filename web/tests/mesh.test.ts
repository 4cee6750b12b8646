import { expect, test } from "vitest";
import { curvatureField, distanceField, qualityField } from "../src/mesh/fields";
import { readObj } from "../src/mesh/obj";
import { readPly } from "../src/mesh/ply";
import { cutAcross, Segments } from "../src/mesh/section";
import { Slabs } from "../src/mesh/slabs";
import { readStl } from "../src/mesh/stl";
import { thinOut } from "../src/mesh/thin_out";
import { boundsOf, isClosed, type Triangles, volumeOf } from "../src/mesh/triangles";
import { sphere, stlOf, tetrahedron } from "./solids";

test("a binary STL is welded to the vertices it was made of", () => {
  const mesh = readStl(stlOf(tetrahedron(10)));
  expect(mesh.positions.length / 3).toBe(4);
  expect(mesh.faces.length / 3).toBe(4);
  expect(isClosed(mesh)).toBe(true);
  expect(volumeOf(mesh)).toBeCloseTo(1000 / 6, 3);
});

test("a text STL reads as the same", () => {
  const text =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
  const mesh = readStl(new TextEncoder().encode(text).buffer);
  expect([...mesh.faces]).toEqual([0, 1, 2]);
  expect(isClosed(mesh)).toBe(false);
});

test("what is no mesh is refused", () => {
  const nonsense = new TextEncoder().encode("<script>alert(1)</script>".repeat(20)).buffer;
  expect(() => readStl(nonsense)).toThrow("no STL");
  expect(() => readPly(nonsense)).toThrow("no PLY");
  expect(() => readObj(nonsense)).toThrow("no OBJ");
  expect(() => readObj(new TextEncoder().encode("v 0 0 0\nf 1 2 3\n").buffer)).toThrow("no OBJ");
});

test("a PLY that is cut off is refused", () => {
  const head =
    "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n" +
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
  expect(() => readPly(new TextEncoder().encode(head).buffer)).toThrow("cut off");
});

test("polygons of an OBJ become fans, indices may count from the end", () => {
  const mesh = readObj(new TextEncoder().encode("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 3/3 -1\n").buffer);
  expect([...mesh.faces]).toEqual([0, 1, 2, 0, 2, 3]);
});

function cutOf(mesh: Triangles, axis: 0 | 1 | 2, at: number): Float32Array {
  const found = new Segments();
  cutAcross(mesh, new Slabs(mesh, axis), axis, at, found);
  return found.ends.slice(0, found.length);
}

test("a section through the middle of a sphere is a circle", () => {
  const cut = cutOf(sphere(50, 32), 2, 0.01);
  let length = 0;
  for (let i = 0; i < cut.length; i += 6) {
    length += Math.hypot(cut[i]! - cut[i + 3]!, cut[i + 1]! - cut[i + 4]!, cut[i + 2]! - cut[i + 5]!);
    expect(cut[i + 2]).toBeCloseTo(0.01, 5);
  }
  expect(length).toBeGreaterThan(2 * Math.PI * 50 * 0.99);
  expect(length).toBeLessThan(2 * Math.PI * 50 * 1.001);
  expect(cutOf(sphere(50, 8), 2, 60).length).toBe(0);
});

test("slabs leave out no face a plane meets, wherever it is", () => {
  const mesh = sphere(50, 24);
  const all = Array.from({ length: mesh.faces.length / 3 }, (_, face) => face);
  for (const axis of [0, 1, 2] as const) {
    const slabs = new Slabs(mesh, axis);
    for (let at = -51; at <= 51; at += 0.37) {
      const met = all.filter((face) => {
        const places = [0, 1, 2].map((k) => mesh.positions[3 * mesh.faces[3 * face + k]! + axis]!);
        return Math.min(...places) <= at && at <= Math.max(...places);
      });
      const near = new Set(slabs.facesNear(at));
      expect(met.filter((face) => !near.has(face))).toEqual([]);
      expect(near.size).toBeLessThan(all.length / 4);
    }
  }
});

test("a section takes the place of the one before, in the same memory", () => {
  const mesh = sphere(50, 128);
  const slabs = new Slabs(mesh, 0);
  const found = new Segments();
  cutAcross(mesh, slabs, 0, 0.01, found);
  const [ends, length] = [found.ends, found.length];
  cutAcross(mesh, slabs, 0, 49, found);
  expect(found.length).toBeLessThan(length);
  cutAcross(mesh, slabs, 0, 0.01, found);
  expect([found.ends === ends, found.length === length]).toEqual([true, true]);
});

test("the curvature of a sphere is one over its radius, and positive outside", () => {
  const values = [...curvatureField(sphere(20, 48))].sort((a, b) => a - b);
  expect(values[Math.floor(values.length / 2)]).toBeCloseTo(1 / 20, 3);
});

test("the distance between two spheres is the difference of their radii", () => {
  const values = distanceField(sphere(17, 24), sphere(20, 64));
  for (const value of values) {
    expect(value).toBeGreaterThan(2.9);
    expect(value).toBeLessThan(3.01);
  }
});

test("an equilateral triangle has quality 1, a needle almost none", () => {
  const equilateral = {
    positions: Float32Array.from([0, 0, 0, 1, 0, 0, 0.5, Math.sqrt(3) / 2, 0]),
    faces: Uint32Array.from([0, 1, 2]),
  };
  for (const q of qualityField(equilateral)) expect(q).toBeCloseTo(1, 5);
  const needle = {
    positions: Float32Array.from([0, 0, 0, 1, 0, 0, 0.5, 0.001, 0]),
    faces: Uint32Array.from([0, 1, 2]),
  };
  for (const q of qualityField(needle)) expect(q).toBeLessThan(1e-4);
});

test("a mesh thinned out for display keeps its shape and its budget", () => {
  const fine = sphere(100, 120);
  const coarse = thinOut(fine, 4000);
  expect(fine.faces.length / 3).toBeGreaterThan(20_000);
  expect(coarse.faces.length / 3).toBeLessThanOrEqual(4000);
  expect(coarse.faces.length / 3).toBeGreaterThan(800);
  expect(volumeOf(coarse) / volumeOf(fine)).toBeGreaterThan(0.95);
  expect(boundsOf(coarse.positions).max[0]).toBeGreaterThan(95);
  expect(thinOut(fine, 1e6)).toBe(fine);
});
