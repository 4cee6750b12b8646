import type { Schema } from "../api/types";

/** Uploads that are no surfaces. */
export type UploadKind = "volume" | "field" | "coil";
const UPLOADS: Record<string, UploadKind> = {
  "application/x-integument-volume": "volume",
  "application/x-integument-field": "field",
  "application/x-integument-coil": "coil",
};

/** Which control an input gets. It depends on its schema alone, so processes that come later get a form by themselves. */
export type Kind =
  | "reference"
  | "package"
  | UploadKind
  | "references"
  | "named_references"
  | "layers"
  | "tissues"
  | "regions"
  | "auto_or_regions"
  | "depths"
  | "numbers"
  | "names"
  | "chosen_names"
  | "words"
  | "holders"
  | "placement"
  | "choice"
  | "flag"
  | "number"
  | "text"
  | "group"
  | "json";

export function kindOf(schema: Schema): Kind {
  if (isReference(schema))
    return acceptsUploads(schema) ? (acceptsResults(schema) ? "reference" : uploadKindOf(schema)) : "package";
  const items = schema.items;
  if (schema.type === "array" && items) {
    if (isReference(items)) return "references";
    if (items.properties?.box_mm) return "regions";
    if (isRowOfFour(schema) && isRowOfFour(items)) return "placement";
    if (items.properties?.depth_mm && items.properties.name) return "layers";
    if (items.properties?.mesh && isReference(items.properties.mesh) && items.properties.name) return "tissues";
    // names of surfaces have a pattern, other words have none
    if (items.type === "string" && !items.enum) return items.pattern ? "chosen_names" : "words";
  }
  const among = schema.anyOf ?? schema.oneOf;
  if (among) {
    if (among.some((one) => one.type === "array" && one.items && isReference(one.items))) return "references";
    if (among.some((one) => one.items?.properties?.box_mm) && among.some((one) => one.enum)) return "auto_or_regions";
    return "json";
  }
  if (schema.enum) return "choice";
  if (schema.type === "boolean") return "flag";
  if (schema.type === "number" || schema.type === "integer") return "number";
  if (schema.type === "string") return "text";
  if (schema.type === "object") {
    const values = typeof schema.additionalProperties === "object" ? schema.additionalProperties : null;
    if (values && isReference(values)) return "named_references";
    if (values?.type === "number" && schema.description?.includes("depth")) return "depths";
    if (values?.type === "number" || values?.type === "integer") return "numbers";
    if (values?.type === "string") return values.nullable ? "holders" : "names";
    if (schema.properties) return "group";
  }
  return "json";
}

/** A list of exactly four; of four of them a 4 x 4 matrix is made. */
function isRowOfFour({ type, minItems, maxItems }: Schema): boolean {
  return type === "array" && minItems === 4 && maxItems === 4;
}

export function isReference(schema: Schema): boolean {
  return schema.properties?.href !== undefined;
}

function uploadKindOf(schema: Schema): UploadKind {
  return UPLOADS[schema.properties?.href?.contentMediaType ?? ""] ?? "volume";
}

function acceptsUploads(schema: Schema): boolean {
  return schema.properties?.href?.pattern?.includes("/v1/meshes/") ?? false;
}

function acceptsResults(schema: Schema): boolean {
  return schema.properties?.href?.pattern?.includes("/v1/jobs/") ?? false;
}

/** The schema of a region among the alternatives of an input, or in its items. */
export function regionSchema(schema: Schema): Schema | undefined {
  return schema.items ?? (schema.anyOf ?? schema.oneOf)?.find((one) => one.items?.properties?.box_mm)?.items;
}

/** `min_gap_mm` -> "Min gap (mm)". */
export function labelOf(name: string): string {
  const words = name.replace(/_s_per_m$/, "_S/m").split("_");
  const unit = { mm: "mm", "S/m": "S/m", mm3: "mm³", cm2: "cm²", deg: "°", s: "s" }[words.at(-1) ?? ""];
  if (unit && words.length > 1) words.pop();
  const text = words.join(" ");
  return text.charAt(0).toUpperCase() + text.slice(1) + (unit ? ` (${unit})` : "");
}

/** What the server takes for granted need not be sent: only what was set, and nothing that was emptied again. */
export function withoutEmpty(values: Record<string, unknown>): Record<string, unknown> {
  return Object.fromEntries(Object.entries(values).filter(([, value]) => value !== undefined && value !== ""));
}
