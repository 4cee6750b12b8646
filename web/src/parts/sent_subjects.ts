import { useEffect, useRef, useState } from "preact/hooks";
import { deleteMesh } from "../api/meshes";
import { isOfEarlierKey, isPassing } from "../api/server";
import type { MeshInfo, Unit } from "../api/types";
import { makeMesh, type Sending, sendFile } from "../api/uploads";
import { useKeyCount } from "./key_count";
import { isArchive, type Subject } from "./subject";

const AGAIN_MS = 5000;
const AT_ONCE = 2; // more lines do not make the network faster, and the server reads few files at a time

/** The subjects of a cohort: files are sent a few at a time, and read as soon as their unit is known. */
export function useSubjects(unit: Unit | "") {
  const keys = useKeyCount();
  const [subjects, setSubjects] = useState<Subject[]>([]);
  const busy = useRef(new Map<number, Sending | null>());
  const last = useRef(0);
  const change = (number: number, part: Partial<Subject>) =>
    setSubjects((all) => all.map((one) => (one.number === number ? { ...one, ...part } : one)));

  useEffect(() => {
    const next = subjects.find((one) => waitsFor(one, unit) && !busy.current.has(one.number));
    if (!next || busy.current.size >= AT_ONCE) return;
    // an upload is read once: for another unit the file is sent anew
    const stale = next.mesh;
    if (stale) void deleteMesh(stale.id).catch(() => {}); // one too many on the server harms nobody
    const sending = next.upload && !stale ? null : sendFile(next.file!, (share) => change(next.number, { share }));
    busy.current.set(next.number, sending);
    const work =
      sending?.done.then((upload) => ({ upload, share: 1, mesh: undefined, unit: undefined })) ??
      read(next.upload!, unit as Unit);
    work.then(
      (part) => finish(next.number, part),
      (error) => finish(next.number, error?.name === "AbortError" ? {} : { error }),
    );
  });
  // a page that is left sends nothing more
  useEffect(
    () => () => {
      for (const sending of busy.current.values()) sending?.stop();
    },
    [],
  );

  // what was refused for want of a key, or found no server, is tried again
  const forgive = (which: (error: unknown) => boolean) =>
    setSubjects((all) => all.map((one) => (which(one.error) ? { ...one, error: undefined } : one)));
  useEffect(() => forgive(isOfEarlierKey), [keys]);
  const finish = (number: number, part: Partial<Subject>) => {
    busy.current.delete(number);
    change(number, part);
    if (isPassing(part.error)) setTimeout(() => forgive(isPassing), AGAIN_MS);
  };
  const add = (more: Omit<Subject, "number" | "share">[]) =>
    setSubjects((all) => [...all, ...more.map((one) => ({ ...one, number: ++last.current, share: 0 }))]);
  return {
    subjects,
    addFiles: (files: readonly File[]) => add(files.map((file) => ({ file, title: file.name }))),
    addMesh: (mesh: MeshInfo) => add([{ mesh, title: mesh.name }]),
    remove: (number: number) => {
      busy.current.get(number)?.stop();
      setSubjects((all) => all.filter((one) => one.number !== number));
    },
  };
}

async function read(upload: string, unit: Unit): Promise<Partial<Subject>> {
  return { mesh: await makeMesh(upload, unit), unit };
}

/** True while there is something to do for this line. An archive goes with the request itself. */
function waitsFor(one: Subject, unit: Unit | ""): boolean {
  if (!one.file || one.error || isArchive(one)) return false;
  return !one.upload || (unit !== "" && one.unit !== unit);
}
