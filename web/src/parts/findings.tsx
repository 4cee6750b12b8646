import { useState } from "preact/hooks";
import type { Finding, Severity } from "../api/types";
import type { Point } from "../viewer/surface";
import { plain, sayCount } from "../words";

const TONES: Record<Severity, string> = { error: "bad", warning: "warn", info: "live" };

const FIRST = 6;

/** What checks have seen, each with a way to its place. */
export function Findings({
  findings,
  onPlace,
}: {
  findings: readonly Finding[];
  onPlace?: (point: Point, finding: Finding) => void;
}) {
  const [whole, setWhole] = useState<readonly Finding[]>([]); // whose places are all shown
  if (findings.length === 0) return <p class="muted">No findings.</p>;
  return (
    <ul class="list">
      {findings.map((finding) => (
        <li key={finding.code + finding.message} class="item">
          <div class="finding">
            <span class={`tag ${TONES[finding.severity]}`}>{finding.severity}</span>
            <span>
              {plain(finding.message)} <span class="mono muted">{finding.code}</span>
              {finding.count > 1 && <span class="muted"> × {sayCount(finding.count)}</span>}
            </span>
          </div>
          {onPlace && finding.places.length > 0 && (
            <div class="row">
              {finding.places.slice(0, whole.includes(finding) ? undefined : FIRST).map((place, number) => (
                <button
                  key={`${place.mesh}${place.point_mm}`}
                  type="button"
                  class="quiet"
                  onClick={() => onPlace(place.point_mm, finding)}
                  aria-label={`Show place ${number + 1} of: ${finding.message}`}
                >
                  Place {number + 1}
                </button>
              ))}
              {finding.places.length > FIRST && !whole.includes(finding) && (
                <button type="button" class="quiet" onClick={() => setWhole([...whole, finding])}>
                  and {finding.places.length - FIRST} more
                </button>
              )}
            </div>
          )}
        </li>
      ))}
    </ul>
  );
}
