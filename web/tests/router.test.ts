import { expect, test } from "vitest";
import { parsePlace } from "../src/router";

test("a fragment is a path and a query", () => {
  const place = parsePlace("#/jobs/1%2F2?tab=report");
  expect(place.path).toEqual(["jobs", "1/2"]);
  expect(place.query.get("tab")).toBe("report");
});

test("nothing is the first page", () => {
  for (const hash of ["", "#", "#/"]) expect(parsePlace(hash).path).toEqual([]);
});
