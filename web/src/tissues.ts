/** One colour per tissue, the same as in the reports (core/reports/palette.py). */

const KNOWN: Record<string, string> = {
  skin: "#c98f6b",
  fat: "#e8b83a",
  average_body: "#b22234",
  muscle: "#b22234",
  bone: "#8b98a2",
  skull: "#8b98a2",
  csf: "#1880b2",
  gm: "#785e96",
  wm: "#3e3a6e",
  cartilage: "#348c6e",
};
const OTHERS = ["#00728c", "#cc5c1e", "#548235", "#963c78", "#4650a0", "#8c6e14"];

export function tissueColours(names: readonly string[]): Record<string, string> {
  const chosen: Record<string, string> = {};
  for (const name of names) {
    const known = KNOWN[name.toLowerCase().replaceAll("-", "_")];
    const taken = new Set(Object.values(chosen));
    chosen[name] =
      known && !taken.has(known)
        ? known
        : (OTHERS.find((colour) => !taken.has(colour)) ?? OTHERS[Object.keys(chosen).length % OTHERS.length]!);
  }
  return chosen;
}
