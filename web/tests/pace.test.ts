import { expect, test } from "vitest";
import { Pace } from "../src/viewer/pace";

function drawn(pace: Pace, frames: number, everyMs: number, from = 0): number {
  let share = 1;
  for (let frame = 0; frame < frames; frame++) share = pace.moving(from + frame * everyMs);
  return share;
}

test("a device that keeps up draws sharp", () => {
  expect(drawn(new Pace(), 100, 16.7)).toBe(1);
});

test("a slow one draws coarser step by step, and sharper again when it has become fast", () => {
  const pace = new Pace();
  expect(drawn(pace, 6, 60)).toBe(0.75);
  expect(drawn(pace, 20, 60, 1000)).toBe(0.5);
  expect(drawn(pace, 200, 16, 10_000)).toBe(1);
});

test("pauses between movements are no slow frames", () => {
  expect(drawn(new Pace(), 50, 400)).toBe(1);
});
