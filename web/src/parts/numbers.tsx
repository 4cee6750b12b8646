import type { Report } from "../api/types";
import { sayCount, sayNumber } from "../words";

/** The table people look at first: faces, area, volume, depth, on-target share, smallest gap, quality. */
export function Numbers({ report }: { report: Report }) {
  const meshes = Object.entries(report.meshes);
  if (meshes.length === 0) return null;
  return (
    <section class="card stack" aria-label="Numbers">
      <h2>Numbers</h2>
      <div class="scroll-x">
        <table>
          <thead>
            <tr>
              <th>Surface</th>
              <th class="number">Faces</th>
              <th class="number">Area (cm²)</th>
              <th class="number">Volume (l)</th>
              <th class="number">Lowest q</th>
            </tr>
          </thead>
          <tbody>
            {meshes.map(([name, one]) => (
              <tr key={name}>
                <td class="name">{name}</td>
                <td class="number">{sayCount(one.faces)}</td>
                <td class="number">{sayNumber(one.area_mm2 / 100)}</td>
                <td class="number">{one.volume_mm3 === null ? "–" : sayNumber(one.volume_mm3 / 1e6)}</td>
                <td class="number">{sayNumber(one.quality.minimum)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {Object.keys(report.thickness ?? {}).length > 0 && (
        <div class="scroll-x">
          <table>
            <thead>
              <tr>
                <th>Layer</th>
                <th class="number">Depth (mm)</th>
                <th class="number">On target</th>
                <th class="number">Limited</th>
                <th class="number">Least (mm)</th>
              </tr>
            </thead>
            <tbody>
              {Object.entries(report.thickness).map(([name, one]) => (
                <tr key={name}>
                  <td class="name">{name}</td>
                  <td class="number">{sayNumber(one.target_mm)}</td>
                  <td class="number">{(100 * one.on_target_area).toFixed(2)} %</td>
                  <td class="number">{(100 * one.limited_area).toFixed(2)} %</td>
                  <td class="number">{sayNumber(one.min_mm)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
      {report.pairs.length > 0 && (
        <div class="scroll-x">
          <table>
            <thead>
              <tr>
                <th>Pair</th>
                <th class="number">Intersecting</th>
                <th class="number">Smallest gap (mm)</th>
              </tr>
            </thead>
            <tbody>
              {report.pairs.map((pair) => (
                <tr key={`${pair.a} ${pair.b}`}>
                  <td class="name">
                    {pair.a} – {pair.b}
                  </td>
                  <td class="number">{sayCount(pair.intersecting_pairs)}</td>
                  <td class="number">{pair.min_gap_mm === null ? "–" : sayNumber(pair.min_gap_mm)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
      {report.methods && (
        <details>
          <summary>Methods, to be cited</summary>
          <p class="small">{report.methods}</p>
        </details>
      )}
    </section>
  );
}
