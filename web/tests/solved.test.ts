import { expect, test } from "vitest";
import { readCoil } from "../src/mesh/coil";
import { readMsh } from "../src/mesh/msh";

/** Two tetrahedra, four faces each, as the server writes them; numbered from 1. */
function mshOf(magnitudes: readonly number[], tags: readonly number[] = [1005, 1007]): ArrayBuffer {
  const corners = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
  const places = [...corners, ...corners.map((value) => value + 5)];
  const faces = [0, 4].flatMap((first) => [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2].map((corner) => first + corner + 1));
  const pieces: (string | number[] | { double: number[] })[] = ["$MeshFormat\n2.2 1 8\n", [1], "\n$EndMeshFormat\n"];
  pieces.push(`$Nodes\n${places.length / 3}\n`);
  for (let i = 0; i < places.length / 3; i++) pieces.push([i + 1], { double: places.slice(3 * i, 3 * i + 3) });
  pieces.push("\n$EndNodes\n", `$Elements\n${faces.length / 3}\n`, [2, faces.length / 3, 2]);
  for (let f = 0; f < faces.length / 3; f++) {
    const tag = tags[f < 4 ? 0 : 1]!;
    pieces.push([f + 1, tag, tag, ...faces.slice(3 * f, 3 * f + 3)]);
  }
  pieces.push("\n$EndElements\n", `$ElementData\n1\n"magnE"\n1\n0.0\n3\n0\n1\n${magnitudes.length}\n`);
  magnitudes.forEach((value, f) => {
    pieces.push([f + 1], { double: [value] });
  });
  pieces.push("\n$EndElementData\n");
  const bytes = pieces.map((piece) => {
    if (typeof piece === "string") return new TextEncoder().encode(piece);
    return new Uint8Array(
      Array.isArray(piece) ? Int32Array.from(piece).buffer : Float64Array.from(piece.double).buffer,
    );
  });
  return new Uint8Array(bytes.flatMap((part) => [...part])).buffer;
}

test("a field comes back surface by surface, with a number per face", () => {
  const [inner, outer] = readMsh(mshOf([1, 2, 3, 4, 5, Number.NaN, 7, 8]));
  expect([...inner!.values]).toEqual([1, 2, 3, 4]);
  expect([...outer!.values]).toEqual([5, Number.NaN, 7, 8]);
  expect([...outer!.mesh.faces.slice(0, 3)]).toEqual([0, 2, 1]);
  expect([...outer!.mesh.positions.slice(0, 6)]).toEqual([5, 5, 5, 6, 5, 5]);
});

test("faces of one tag are one surface", () => {
  expect(readMsh(mshOf([1, 2, 3, 4, 5, 6, 7, 8], [1003, 1003])).map(({ values }) => values.length)).toEqual([8]);
});

test("a file that holds no field is refused", () => {
  expect(() => readMsh(new ArrayBuffer(100))).toThrow("has no $Nodes");
});

test("coils are read as places in mm, from rows and from JSON", async () => {
  const rows = "# a coil\n2\n# x y z mx my mz\n0.01 0 0 0 0 1\n0 -0.02 1e-3 0 0 -1\n";
  expect([...(await readCoil(rows))].map((value) => Math.round(value))).toEqual([10, 0, 0, 0, -20, 1]);
  const deflated = new Blob([Float64Array.from([4, 5, 6])]).stream().pipeThrough(new CompressionStream("deflate"));
  const packed = btoa(String.fromCharCode(...new Uint8Array(await new Response(deflated).arrayBuffer())));
  const told = JSON.stringify({ coilElementList: [{ type: 1, points: [[1, 2, 3]] }, { type: 2, points: packed }, {}] });
  expect([...(await readCoil(told))]).toEqual([1, 2, 3, 4, 5, 6]);
});
