import type { Report } from "../api/types";
import { sayArea, sayCount, sayNumber, sayShare } from "../words";
import { Table } from "./table";

/** The tables people look at first: faces, area, volume, quality; depth and share on target; smallest gaps. */
export function Numbers({ report }: { report: Report }) {
  const meshes = Object.entries(report.meshes);
  const layers = Object.entries(report.thickness ?? {});
  if (meshes.length === 0) return null;
  return (
    <section class="card stack" aria-label="Numbers">
      <h2>Numbers</h2>
      <Table
        rows={meshes}
        keyOf={([name]) => name}
        columns={[
          { title: "Surface", kind: "name", cell: ([name]) => name },
          { title: "Faces", kind: "number", cell: ([, one]) => sayCount(one.faces) },
          { title: "Area (cm²)", kind: "number", cell: ([, one]) => sayArea(one.area_mm2) },
          {
            title: "Volume (l)",
            kind: "number",
            cell: ([, one]) => (one.volume_mm3 === null ? "–" : sayNumber(one.volume_mm3 / 1e6)),
          },
          { title: "Lowest q", kind: "number", cell: ([, one]) => sayNumber(one.quality.minimum) },
        ]}
      />
      {layers.length > 0 && (
        <Table
          rows={layers}
          keyOf={([name]) => name}
          columns={[
            { title: "Layer", kind: "name", cell: ([name]) => name },
            { title: "Depth (mm)", kind: "number", cell: ([, one]) => sayNumber(one.target_mm) },
            { title: "On target", kind: "number", cell: ([, one]) => sayShare(one.on_target_area) },
            { title: "Limited", kind: "number", cell: ([, one]) => sayShare(one.limited_area) },
            { title: "Least (mm)", kind: "number", cell: ([, one]) => sayNumber(one.min_mm) },
          ]}
        />
      )}
      {report.pairs.length > 0 && (
        <Table
          rows={report.pairs}
          keyOf={({ a, b }) => `${a} ${b}`}
          columns={[
            { title: "Pair", kind: "name", cell: ({ a, b }) => `${a} – ${b}` },
            { title: "Intersecting", kind: "number", cell: (pair) => sayCount(pair.intersecting_pairs) },
            {
              title: "Smallest gap (mm)",
              kind: "number",
              cell: (pair) => (pair.min_gap_mm === null ? "–" : sayNumber(pair.min_gap_mm)),
            },
          ]}
        />
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
