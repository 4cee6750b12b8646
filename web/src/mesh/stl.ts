import type { Triangles } from "./triangles";
import { weld } from "./weld";

const HEADER = 84;
const FACET = 50;

/** STL, binary or text. The file may be anybody's: what does not add up is refused, nothing is guessed. */
export function readStl(data: ArrayBuffer): Triangles {
  const view = new DataView(data);
  if (data.byteLength >= HEADER && data.byteLength === HEADER + FACET * view.getUint32(80, true))
    return readBinary(view);
  return readText(data);
}

function readBinary(view: DataView): Triangles {
  const count = view.getUint32(80, true);
  const corners = new Float32Array(9 * count);
  for (let f = 0; f < count; f++) {
    const start = HEADER + FACET * f + 12;
    for (let k = 0; k < 9; k++) corners[9 * f + k] = view.getFloat32(start + 4 * k, true);
  }
  return weld(corners);
}

function readText(data: ArrayBuffer): Triangles {
  const text = new TextDecoder("utf-8", { fatal: false }).decode(data);
  const numbers: number[] = [];
  for (const match of text.matchAll(/^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)/gim)) {
    numbers.push(Number(match[1]), Number(match[2]), Number(match[3]));
  }
  if (numbers.length === 0 || numbers.length % 9 !== 0) throw new Error("This is no STL file.");
  return weld(Float32Array.from(numbers));
}
