import type { Verdict as Word } from "../api/types";

export function Verdict({ verdict }: { verdict: Word | undefined }) {
  if (!verdict) return null;
  return verdict === "simulation_ready" ? (
    <span class="tag good">✓ ready</span>
  ) : (
    <span class="tag bad">✗ not ready</span>
  );
}
