import { expect, test } from "vitest";
import { isRigid, ORIGIN, placed, placementOf, readPlacement, standOf } from "../src/form/placement";

test("a coil on top of a head, facing down, handle to the back", () => {
  const placement = placementOf({ position: [1, 2, 95], towards: [0, 0, -3], handle: [0, -2, 1] })!;
  expect(placement).toEqual([
    [1, 0, 0, 1],
    [0, -1, 0, 2],
    [0, 0, -1, 95],
    [0, 0, 0, 1],
  ]);
  expect(isRigid(placement)).toBe(true);
  expect(placed(placement, [10, 20, 30])).toEqual([11, -18, 65]);
  expect(standOf(placement)).toEqual({ position: [1, 2, 95], towards: [0, 0, -1], handle: [0, -1, 0] });
});

test("directions that are none or the same place nothing", () => {
  expect(placementOf({ ...ORIGIN, towards: [0, 0, 0] })).toBeNull();
  expect(placementOf({ ...ORIGIN, handle: [0, 0, 7] })).toBeNull();
});

test("a matrix is read however its numbers are set apart", () => {
  const rows = [
    [0, -1, 0, 1.5],
    [1, 0, 0, -20],
    [0, 0, 1, 3],
    [0, 0, 0, 1],
  ];
  for (const text of [JSON.stringify(rows), "0 -1 0 1.5; 1,0,0,-2e1\n0\t0 1 3 0 0 0 1", "0 -1 0 1.5 1 0 0 -20 0 0 1 3"])
    expect(readPlacement(text)).toEqual(rows);
  expect(readPlacement("95")).toBeNull();
  expect(isRigid(rows)).toBe(true);
});

test.each([
  ["a scale", [2, 0, 0, 0]],
  ["a mirror", [-1, 0, 0, 0]],
  ["a shear", [1, 0.1, 0, 0]],
])("%s is no placement", (_what, row) => {
  expect(isRigid([row, [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])).toBe(false);
});
