import { useEffect, useId, useRef, useState } from "preact/hooks";
import { isOfEarlierKey, isPassing } from "../api/server";
import type { MeshInfo, Unit } from "../api/types";
import { makeMesh, type Sending, sendFile } from "../api/uploads";
import type { FileKind, ReadMesh } from "../mesh/worker";
import { readMesh } from "../mesh/workshop";
import { doubtUnit, sayLength, suggestUnit, toMm, UNIT_NAMES, UNITS } from "../units";
import { sayBytes, sayCount, sayNumber } from "../words";
import { Failure } from "./failure";
import { useKeyCount } from "./key_count";

/** A mesh read by the browser, before the server has it. */
export interface Local {
  name: string;
  mesh: ReadMesh;
}

const READ_HERE: readonly string[] = ["stl", "obj"];
const READ_HERE_BYTES = 300e6;
const AGAIN_MS = 5000;

/** One file on its way: it is sent while its unit is asked for, and shown as soon as the browser has read it. */
export function UploadItem(props: {
  file: File;
  onLocal: (local: Local) => void;
  onDone: (mesh: MeshInfo) => void;
  onRemove: () => void;
}) {
  const { file } = props;
  const id = useId();
  const [share, setShare] = useState(0);
  const [path, setPath] = useState("");
  const [error, setError] = useState<unknown>(null);
  const [extents, setExtents] = useState<number[] | null>(null);
  const [faces, setFaces] = useState(0);
  // the header of a volume tells its unit
  const [unit, setUnit] = useState<Unit | "">(/\.(nii(\.gz)?|mgz|mgh(\.gz)?)$/i.test(file.name) ? "mm" : "");
  const [making, setMaking] = useState(false);
  const [turn, setTurn] = useState(0);
  const sending = useRef<Sending | null>(null);
  const here = useRef(true);
  useEffect(
    () => () => {
      here.current = false;
    },
    [],
  );
  const events = useRef(props);
  events.current = props;

  useEffect(() => {
    const kind = file.name.split(".").pop()?.toLowerCase() ?? "";
    if (!READ_HERE.includes(kind) || file.size > READ_HERE_BYTES) return;
    let gone = false;
    void (async () => {
      try {
        const mesh = await readMesh(await file.arrayBuffer(), kind as FileKind);
        if (gone) return;
        const size = mesh.max.map((high, axis) => high - mesh.min[axis]!);
        setExtents(size);
        setFaces(mesh.faces);
        setUnit((chosen) => chosen || suggestUnit(size) || "");
        events.current.onLocal({ name: file.name, mesh });
      } catch {
        setExtents(null); // the server reads more than we do, and says what is wrong
      }
    })();
    return () => {
      gone = true;
    };
  }, [file]);

  // `turn` counts the tries
  useEffect(() => {
    setError(null);
    const one = sendFile(file, setShare);
    sending.current = one;
    let timer = 0;
    one.done.then(setPath, (reason) => {
      if (reason?.name === "AbortError") return;
      setError(reason);
      if (isPassing(reason)) timer = window.setTimeout(() => setTurn((turn) => turn + 1), AGAIN_MS);
    });
    return () => {
      clearTimeout(timer);
      one.stop();
    };
  }, [file, turn]);

  const keys = useKeyCount();
  useEffect(() => {
    if (!path && isOfEarlierKey(error)) setTurn(turn + 1); // goes on where it was
  }, [keys]);

  const make = async () => {
    if (!unit) return;
    setMaking(true);
    try {
      const mesh = await makeMesh(path, unit);
      if (here.current) events.current.onDone(mesh); // who has gone elsewhere meanwhile is not called back
    } catch (reason) {
      setError(reason);
      setMaking(false);
    }
  };
  const suggested = extents && suggestUnit(extents);
  const longest = extents && Math.max(...extents);
  const doubt = longest && unit ? doubtUnit(longest, unit) : "";
  return (
    <article class="card stack" aria-label={`Upload of ${file.name}`}>
      <div class="row spread">
        <span class="name">{file.name}</span>
        <span class="muted small">
          {sayBytes(file.size)}
          {faces > 0 && ` · ${sayCount(faces)} faces`}
        </span>
      </div>
      <progress value={path ? 1 : share} max={1} aria-label={`Progress of ${file.name}`} />
      <p class="muted small" aria-live="polite">
        {path
          ? "Received."
          : share < 1
            ? `${Math.floor(share * 100)} % sent; it goes on where it was if the network fails.`
            : "All of it is sent; the server puts it away."}
      </p>
      <div class="field">
        <label for={id}>Unit of the coordinates in the file</label>
        <select id={id} value={unit} onChange={(event) => setUnit(event.currentTarget.value as Unit)}>
          <option value="">Choose…</option>
          {UNITS.map((one) => (
            <option key={one} value={one}>
              {UNIT_NAMES[one]}
              {longest ? `: longest side ${sayLength(toMm(longest, one))}` : ""}
            </option>
          ))}
        </select>
        {longest === null && !unit && (
          <p class="muted small">Its size is known when the server has read it; a wrong unit is told then.</p>
        )}
        {longest !== null && (
          <p class="muted small">
            Longest side in the file: {sayNumber(longest)}.{" "}
            {suggested
              ? `That is a person's size in ${UNIT_NAMES[suggested]}.`
              : "The size fits no unit for certain, so please say which it is."}
          </p>
        )}
      </div>
      {doubt && (
        <p class="note warn" role="alert">
          {doubt}
        </p>
      )}
      {error ? <Failure error={error} again={path ? undefined : () => setTurn(turn + 1)} /> : null}
      <div class="row end">
        <button
          type="button"
          class="quiet"
          onClick={() => {
            sending.current?.stop();
            props.onRemove();
          }}
        >
          Remove
        </button>
        <button type="button" class="primary" disabled={!path || !unit || making} onClick={make}>
          {making ? "Reading…" : "Use this mesh"}
        </button>
      </div>
    </article>
  );
}
