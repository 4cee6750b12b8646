import type { Marker, Point } from "../viewer/surface";

/** The places a report names in its tables. */

export interface Place {
  element: HTMLElement;
  marker: Marker;
}

const SEVERITIES = ["error", "warning", "info"] as const;

/** Every element with `data-at="x y z"` in mm; `data-severity` gives the colour. What is no place is left out. */
export function findPlaces(root: ParentNode): Place[] {
  const places: Place[] = [];
  for (const element of root.querySelectorAll<HTMLElement>("[data-at]")) {
    const point = element.dataset.at!.split(" ").map(Number);
    if (point.length !== 3 || !point.every(Number.isFinite)) continue;
    const severity = SEVERITIES.find((one) => one === element.dataset.severity) ?? "info";
    places.push({ element, marker: { point: point as Point, severity } });
  }
  return places;
}
