import { expect, test } from "vitest";
import { readScene, type SceneAbout } from "../src/mesh/scene";
import { isClosed, volumeOf } from "../src/mesh/triangles";

/** What core/reports/scene/scene.py makes of a tetrahedron with legs of 10 mm; tests/core/reports/scene pins it there. */
const ABOUT: SceneAbout = {
  version: 1,
  origin_mm: [0.0, 0.0, 0.0],
  step_mm: 3.8147118175957395e-5,
  surfaces: [{ name: "skin", colour: "#7a4c2c", vertices: 4, faces: 4, of_faces: 4, closed: true }],
};
const DATA = "eJxFyVkKACAMA9HpAr3/gWuNH2og8EgwM2488pn079UwAxViiyPGOVTt1AYIJwwc";

test("a scene packed by the server is read back whole", async () => {
  const [mesh] = await readScene(ABOUT, DATA);
  expect(mesh!.faces.length).toBe(12);
  expect(isClosed(mesh!)).toBe(true);
  expect(volumeOf(mesh!)).toBeCloseTo(1000 / 6, 2);
});

test("what is cut off or of another version is refused", async () => {
  const shorter = { ...ABOUT, surfaces: [{ ...ABOUT.surfaces[0]!, faces: 5 }] };
  await expect(readScene(shorter, DATA)).rejects.toThrow("bytes");
  await expect(readScene({ ...ABOUT, version: 9 }, DATA)).rejects.toThrow("version");
});
