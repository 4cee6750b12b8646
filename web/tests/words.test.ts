import { expect, test } from "vitest";
import type { Job } from "../src/api/types";
import { sayArea, sayBytes, sayCount, sayNumber, sayOutcome, saySeconds, sayShare } from "../src/words";

test.each([
  [0, "0"],
  [0.05, "0.050"],
  [-1.234, "-1.23"],
  [123.45, "123.5"],
  [26836, "26,836.0"],
  [123456.78, "123,456.8"],
  [3.2e8, "3.20e+8"],
  [4e-5, "4.00e-5"],
])("%d is said as %s", (value, told) => {
  expect(sayNumber(value)).toBe(told);
});

test("counts, areas, shares, sizes and times are said as everywhere else", () => {
  expect(sayCount(26836)).toBe("26,836");
  expect(sayArea(1_612_345)).toBe("16,123.5");
  expect(sayShare(0.99514)).toBe("99.51 %");
  expect(sayBytes(5_351_284)).toBe("5.35 MB");
  expect(saySeconds(125)).toBe("2 min 5 s");
});

test("a job is told by what came of it, else by how it goes", () => {
  const job = { message: "accepted", phase: "load" } as Job;
  expect(sayOutcome(job)).toBe("load");
  expect(sayOutcome({ ...job, failure: { message: "too small" } } as Job)).toBe("too small");
  expect(sayOutcome({ ...job, summary: "ready" } as Job)).toBe("ready");
});
