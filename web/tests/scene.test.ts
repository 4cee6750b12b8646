import { expect, test } from "vitest";
import { readScene, type SceneAbout, type SceneMesh } from "../src/mesh/scene";
import { isClosed, volumeOf } from "../src/mesh/triangles";

/** What core/reports/scene/scene.py makes of a tetrahedron with legs of 10 mm; tests/core/reports/scene pins it there. */
const ABOUT: SceneAbout = {
  version: 2,
  origin_mm: [0.0, 0.0, 0.0],
  step_mm: 3.8147118175957395e-5,
  surfaces: [{ name: "skin", colour: "#7a4c2c", vertices: 4, faces: 4, of_faces: 4, closed: true, deepest_mm: 2.0 }],
};
const DATA = "eJxFydEJACAMQ8FXW+hc7j9TrfFDDQSOBDPjZng8E+N7FXRDulhii34OVTtpzdw72Q1d";

test("a scene packed by the server is read back whole", async () => {
  const [{ mesh, depths }] = (await readScene(ABOUT, DATA)) as [SceneMesh];
  expect(mesh.faces.length).toBe(12);
  expect(isClosed(mesh)).toBe(true);
  expect(volumeOf(mesh)).toBeCloseTo(1000 / 6, 2);
  const known = depths!.filter((depth) => !Number.isNaN(depth)).sort();
  expect(known.length).toBe(3); // one vertex has none
  expect(known[0]).toBe(0);
  expect(known[1]).toBeCloseTo(0.5, 2);
  expect(known[2]).toBeCloseTo(2, 6);
});

test("what is cut off or of another version is refused", async () => {
  const shorter = { ...ABOUT, surfaces: [{ ...ABOUT.surfaces[0]!, faces: 5 }] };
  await expect(readScene(shorter, DATA)).rejects.toThrow("bytes");
  await expect(readScene({ ...ABOUT, version: 9 }, DATA)).rejects.toThrow("version");
});
