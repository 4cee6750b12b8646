import { useEffect, useRef, useState } from "preact/hooks";
import type { MeshInfo, Unit } from "../api/types";
import { makeMesh, type Sending, sendFile } from "../api/uploads";
import { isArchive, type Subject } from "./subject";

const AT_ONCE = 2; // more lines do not make the network faster, and the server reads few files at a time

/** The subjects of a cohort: files are sent a few at a time, and read as soon as their unit is known. */
export function useSubjects(unit: Unit | "") {
  const [subjects, setSubjects] = useState<Subject[]>([]);
  const busy = useRef(new Map<number, Sending | null>());
  const last = useRef(0);
  const change = (number: number, part: Partial<Subject>) =>
    setSubjects((all) => all.map((one) => (one.number === number ? { ...one, ...part } : one)));

  useEffect(() => {
    const next = subjects.find((one) => waitsFor(one, unit) && !busy.current.has(one.number));
    if (!next || busy.current.size >= AT_ONCE) return;
    const work = next.upload ? read(next.upload, unit as Unit) : send(next);
    busy.current.set(next.number, null);
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

  const finish = (number: number, part: Partial<Subject>) => {
    busy.current.delete(number);
    change(number, part);
  };
  const send = async (subject: Subject): Promise<Partial<Subject>> => {
    const sending = sendFile(subject.file!, (share) => change(subject.number, { share }));
    queueMicrotask(() => busy.current.has(subject.number) && busy.current.set(subject.number, sending));
    return { upload: await sending.done, share: 1 };
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
