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
      "Skin, fat, average body, skull, CSF, grey and white matter, from the skin of a head alone: at usual depths below it, thinner where the head is.",
    process: "shells",
    values: {
      layers: [
        { name: "fat", depth_mm: 1, side: "inside" },
        { name: "average_body", depth_mm: 3, side: "inside" },
        { name: "skull", depth_mm: 6, side: "inside" },
        { name: "csf", depth_mm: 12, side: "inside" },
        { name: "gm", depth_mm: 15, side: "inside" },
        { name: "wm", depth_mm: 18, side: "inside" },
      ],
    },
  },
  {
    title: "Head, 7 tissues you have",
    about:
      "Your own skull, CSF, grey and white matter below fat at 1 mm and average body at 3 mm: set apart where they touch, proven, and filled with tetrahedra.",
    process: "prepare",
    values: {
      layers: [
        { name: "fat", depth_mm: 1, side: "inside" },
        { name: "average_body", depth_mm: 3, side: "inside" },
      ],
      tissues: ["skull", "csf", "gm", "wm"].map((name) => ({ name, mesh: { href: "" } })),
    },
  },
];
