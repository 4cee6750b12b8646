import { expect, test } from "vitest";
import { findBoxes, withRegion } from "../src/form/boxes";
import { kindOf, labelOf, withoutEmpty } from "../src/form/schema_kind";
import { freshName } from "../src/form/values";
import { referencesIn, shownMeshes } from "../src/parts/shown_meshes";

const ID = "207ed415-8dce-4b02-af94-d30610c4aef0";
const MESH = { type: "object", properties: { href: { type: "string", pattern: "^(/v1/meshes/x|/v1/jobs/y)$" } } };
const PACKAGE = { type: "object", properties: { href: { type: "string", pattern: "^/v1/jobs/y$" } } };
const VOLUME = { type: "object", properties: { href: { type: "string", pattern: "^/v1/meshes/x$" } } };
const COIL = {
  type: "object",
  properties: {
    href: { type: "string", pattern: "^/v1/meshes/x$", contentMediaType: "application/x-integument-coil" },
  },
};
const BOX = { type: "array", items: { type: "object", properties: { name: {}, box_mm: {} } } };

test.each([
  [MESH, "reference"],
  [PACKAGE, "package"],
  [VOLUME, "volume"],
  [{ type: "array", items: MESH }, "references"],
  [{ anyOf: [MESH, { type: "array", items: MESH }] }, "references"],
  [{ type: "object", additionalProperties: MESH }, "named_references"],
  [{ type: "array", items: { type: "object", properties: { name: {}, depth_mm: {} } } }, "layers"],
  [{ type: "array", items: { type: "object", properties: { name: {}, mesh: MESH } } }, "tissues"],
  [BOX, "regions"],
  [{ anyOf: [{ type: "string", enum: ["auto"] }, BOX] }, "auto_or_regions"],
  [{ type: "object", additionalProperties: { type: "number" }, description: "Layer -> depth" }, "depths"],
  [{ type: "object", additionalProperties: { type: "integer" } }, "numbers"],
  [{ type: "array", items: { type: "string", pattern: "^[a-z]+$" } }, "chosen_names"],
  [{ type: "array", items: { type: "string" } }, "words"],
  [COIL, "coil"],
  [{ type: "object", additionalProperties: { type: "string" } }, "names"],
  [{ type: "object", additionalProperties: { type: "string", nullable: true } }, "holders"],
  [{ type: "string", enum: ["a", "b"] }, "choice"],
  [{ type: "boolean" }, "flag"],
  [{ type: "integer" }, "number"],
  [{ type: "string" }, "text"],
  [{ type: "object", properties: { radius_mm: { type: "number" } } }, "group"],
  [{ type: "array", items: { type: "array" } }, "json"],
  [
    { type: "array", minItems: 4, maxItems: 4, items: { type: "array", minItems: 4, maxItems: 4, items: {} } },
    "placement",
  ],
] as const)("a schema gets its control: %#", (schema, kind) => {
  expect(kindOf(schema as Parameters<typeof kindOf>[0])).toBe(kind);
});

test("names of inputs are read aloud with their units", () => {
  expect(labelOf("min_gap_mm")).toBe("Min gap (mm)");
  expect(labelOf("conductivities_s_per_m")).toBe("Conductivities (S/m)");
  expect(labelOf("skin")).toBe("Skin");
});

test("what was emptied is not sent; nothing and no are values", () => {
  expect(withoutEmpty({ a: undefined, b: "", c: 0, d: false, e: [] })).toEqual({ c: 0, d: false, e: [] });
});

test("names stay apart", () => {
  expect(freshName("region", ["region", "region_2"])).toBe("region_3");
});

test("references are found wherever they stand, packages are no surface", () => {
  const inputs = { skin: { href: `/v1/meshes/${ID}` }, canals: [{ href: `/v1/jobs/${ID}/results/fat` }], depth: 3 };
  expect(referencesIn(inputs)).toEqual({ skin: `/v1/meshes/${ID}`, canals: `/v1/jobs/${ID}/results/fat` });
  expect(referencesIn({ volume: { href: `/v1/meshes/${ID}` } })).toEqual({});
  expect(referencesIn({ package: { href: `/v1/jobs/${ID}/results/package` } })).toEqual({});
});

test("a job that only looked shows what it looked at, one that changed a surface shows both", () => {
  const inputs = { mesh: { href: `/v1/meshes/${ID}` } };
  expect(shownMeshes({}, inputs)).toEqual({ mesh: `/v1/meshes/${ID}` });
  const made = { mesh: { href: `http://h/v1/jobs/${ID}/results/mesh`, type: "model/stl", title: "mesh.stl" } };
  expect(shownMeshes(made, inputs)).toEqual({ mesh: `/v1/jobs/${ID}/results/mesh`, "mesh before": `/v1/meshes/${ID}` });
});

test("tissues are called by their names", () => {
  const href = `/v1/meshes/${ID}`;
  const tissues = [
    { name: "gm", mesh: { href } },
    { name: "wm", mesh: { href } },
    { name: "csf", mesh: { href: "" } },
  ];
  expect(referencesIn({ tissues })).toEqual({ gm: href, wm: href });
});

test("boxes are found in groups, and changed there alone", () => {
  const region = { name: "arm", box_mm: { min: [0, 0, 0], max: [1, 1, 1] } };
  const values = { skin: { href: "x" }, detach: { gap_mm: 1, regions: [region, region] } };
  const schemas = { detach: { type: "object", properties: { regions: BOX } } } as Parameters<typeof findBoxes>[0];
  const found = findBoxes(schemas, values);
  expect(found.map(({ path, at }) => [...path, at])).toEqual([
    ["detach", "regions", 0],
    ["detach", "regions", 1],
  ]);
  const other = { ...found[1]!.region, name: "leg" };
  expect(withRegion(values, found[1]!, other)).toEqual({ ...values, detach: { gap_mm: 1, regions: [region, other] } });
});
