/** Settings people ask for by name. */

export interface Preset {
  title: string;
  about: string;
  process: string;
  values: Record<string, unknown>;
}

export const PRESETS: readonly Preset[] = [
  {
    title: "Thesis: VHP-Female",
    about: "Fat at 1 mm, average body at 3 mm; both ears found by themselves, with 0.3 and 0.6 mm there.",
    process: "ears",
    values: {
      layers: [
        { name: "fat", depth_mm: 1, side: "inside" },
        { name: "average_body", depth_mm: 3, side: "inside" },
      ],
      ear_depths_mm: { fat: 0.3, average_body: 0.6 },
      blend_mm: 5,
    },
  },
  {
    title: "Thesis: the whole way",
    about:
      "Mend the skin, find both ears and cut canals, layers as above, then your inner tissues, proof and tetrahedra; all in one job.",
    process: "prepare",
    values: { ears: "auto", generate_canals: {} },
  },
  {
    title: "Skin, fat and average body",
    about: "Fat at 1 mm and average body at 3 mm everywhere, thinner only where the body is.",
    process: "shells",
    values: {
      layers: [
        { name: "fat", depth_mm: 1, side: "inside" },
        { name: "average_body", depth_mm: 3, side: "inside" },
      ],
    },
  },
  {
    title: "Head, 7 shells",
    about:
      "Seven tissue surfaces you have, thinned to half together: still nested, none nearer to another than 0.05 mm.",
    process: "decimate",
    values: { target_ratio: 0.5, min_gap_mm: 0.05 },
  },
];
