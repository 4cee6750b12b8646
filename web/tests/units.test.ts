import { expect, test } from "vitest";
import { doubtUnit, suggestUnit } from "../src/units";

test.each([
  [[993, 1666, 423], "mm"],
  [[0.99, 1.67, 0.42], "m"],
  [[99, 167, 42], "cm"],
  [[39, 66, 17], "in"],
  [[160, 240, 200], "mm"],
  [[0.16, 0.24, 0.2], "m"],
] as const)("extents %j are %s", (extents, unit) => {
  expect(suggestUnit(extents)).toBe(unit);
});

test("what is no person's size is not guessed", () => {
  expect(suggestUnit([3, 3, 3])).toBeNull();
  expect(suggestUnit([1e6, 2e6, 1e6])).toBeNull();
});

test("a unit that makes a giant is doubted, with the one that would fit", () => {
  expect(doubtUnit(1700, "m")).toBe(
    "In metres this is 1.70 km long, unlike a person or a part of one. In millimetres it would be 1.70 m.",
  );
  expect(doubtUnit(1700, "mm")).toBe("");
  expect(doubtUnit(0.0001, "mm")).toContain("No unit here");
});
