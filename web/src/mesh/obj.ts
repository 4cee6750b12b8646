import type { Triangles } from "./triangles";

/** Vertices and faces of a Wavefront OBJ, polygons as fans; for a look before the file is sent. */
export function readObj(data: ArrayBuffer): Triangles {
  const positions: number[] = [];
  const faces: number[] = [];
  for (const line of new TextDecoder().decode(data).split("\n")) {
    const words = line.trim().split(/\s+/);
    if (words[0] === "v") positions.push(Number(words[1]), Number(words[2]), Number(words[3]));
    else if (words[0] === "f") {
      const corners = words.slice(1).map((word) => {
        const index = Number.parseInt(word, 10);
        return index < 0 ? positions.length / 3 + index : index - 1;
      });
      for (let k = 2; k < corners.length; k++) faces.push(corners[0]!, corners[k - 1]!, corners[k]!);
    }
  }
  const count = positions.length / 3;
  if (faces.length === 0 || faces.some((corner) => !(corner >= 0 && corner < count)))
    throw new Error("This is no OBJ mesh.");
  return { positions: Float32Array.from(positions), faces: Uint32Array.from(faces) };
}
