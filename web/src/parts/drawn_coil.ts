import { useMemo } from "preact/hooks";
import { fetchCoil } from "../api/meshes";
import { type Placement, placed } from "../form/placement";
import { useLoaded } from "./loaded";

interface GivenCoil {
  file?: { href?: string };
  placement?: Placement;
}

/** The places of the coil among the inputs, where it was placed; null without one. */
export function useDrawnCoil(inputs: Record<string, unknown> | null): Float32Array | null {
  const { file, placement } = (inputs?.coil ?? {}) as GivenCoil;
  const href = file?.href ? new URL(file.href, location.href).pathname : "";
  const coil = useLoaded(`coil ${href}`, async (signal) => (href ? fetchCoil(href, signal) : null));
  return useMemo(
    () => coil.value && (placement ? moved(coil.value, placement) : coil.value),
    [coil.value, JSON.stringify(placement)],
  );
}

function moved(places: Float32Array, placement: Placement): Float32Array {
  const there = new Float32Array(places.length);
  for (let i = 0; i < places.length; i += 3)
    there.set(placed(placement, [places[i]!, places[i + 1]!, places[i + 2]!]), i);
  return there;
}
