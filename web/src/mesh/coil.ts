/** Where the dipoles and wires of a coil are, x, y, z in mm one after the other, for the eye. The server has read the file before. */
export async function readCoil(text: string): Promise<Float32Array> {
  return text.trimStart().startsWith("{") ? readTcd(text) : readCcd(text);
}

const MM_PER_M = 1000;

/** Rows x y z mx my mz in m; all else is heading. */
function readCcd(text: string): Float32Array {
  const places = text.split("\n").flatMap((line) => {
    const numbers = line
      .trim()
      .split(/[\s,]+/)
      .map(Number);
    return numbers.length === 6 && numbers.every(Number.isFinite) ? numbers.slice(0, 3) : [];
  });
  return Float32Array.from(places, (place) => MM_PER_M * place);
}

/** JSON in mm; places are lists, or base64 of deflated doubles. */
async function readTcd(text: string): Promise<Float32Array> {
  const { coilElementList } = JSON.parse(text) as { coilElementList: { points?: number[][] | string }[] };
  const parts = await Promise.all(
    coilElementList.map(({ points = [] }) => (typeof points === "string" ? unpacked(points) : points.flat())),
  );
  return Float32Array.from(parts.flat());
}

async function unpacked(base64: string): Promise<number[]> {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return [...new Float64Array(await new Response(stream).arrayBuffer())];
}
