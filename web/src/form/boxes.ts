import type { Schema } from "../api/types";
import { kindOf } from "./schema_kind";
import { asRegions, type Region } from "./values";

/** A box somewhere in the inputs, also in a group of them: where it stands, and what it is. */
export interface PlacedBox {
  /** Names of the inputs on the way, the list of boxes last. */
  path: readonly string[];
  at: number;
  region: Region;
}

/** All boxes of the user's, in the order of the form. */
export function findBoxes(
  schemas: Record<string, Schema>,
  values: Record<string, unknown>,
  above: readonly string[] = [],
): PlacedBox[] {
  return Object.entries(schemas).flatMap(([name, schema]) => {
    const path = [...above, name];
    const value = values[name];
    const kind = kindOf(schema);
    if (kind === "regions" || kind === "auto_or_regions")
      return asRegions(value).map((region, at) => ({ path, at, region }));
    if (kind === "group" && typeof value === "object" && value !== null)
      return findBoxes(schema.properties ?? {}, value as Record<string, unknown>, path);
    return [];
  });
}

/** The values with another region at the place of one. */
export function withRegion(
  values: Record<string, unknown>,
  { path, at }: PlacedBox,
  region: Region,
): Record<string, unknown> {
  const [name, ...rest] = path as [string, ...string[]];
  const value = values[name];
  const changed =
    rest.length > 0
      ? withRegion(value as Record<string, unknown>, { path: rest, at, region }, region)
      : asRegions(value).map((one, i) => (i === at ? region : one));
  return { ...values, [name]: changed };
}
