import { messageOf } from "../api/server";
import { removeColumn } from "../form/remove_button";
import { sayLength } from "../units";
import { sayBytes, sayContent } from "../words";
import type { Subject } from "./subject";
import { isArchive } from "./subject";
import { Table } from "./table";

/** A line per subject: what it is, how far it came, what is wrong with it. */
export function SubjectsTable({
  subjects,
  onRemove,
}: {
  subjects: readonly Subject[];
  onRemove: (number: number) => void;
}) {
  if (subjects.length === 0) return null;
  return (
    <Table
      rows={subjects}
      keyOf={(one) => one.number}
      columns={[
        { title: "Subject", kind: "name", cell: (one) => one.title },
        { title: "Size", kind: "small", cell: sizeOf },
        { title: "State", kind: "small", cell: (one) => <State subject={one} /> },
        removeColumn<Subject>(
          (one) => one.title,
          (one) => onRemove(one.number),
        ),
      ]}
    />
  );
}

function sizeOf({ file, mesh }: Subject): string {
  if (mesh) return `${sayContent(mesh)}, ${sayLength(Math.max(...mesh.extents_mm))} long`;
  return file ? sayBytes(file.size) : "";
}

function State({ subject }: { subject: Subject }) {
  const { error, mesh, upload, share } = subject;
  if (error) return <span class="note bad">Left out: {messageOf(error)}</span>;
  const noticed = mesh?.findings.filter((finding) => finding.severity !== "info") ?? [];
  if (noticed.length > 0) return <span class="note warn">{noticed.map((one) => one.message).join(" ")}</span>;
  if (mesh) return <>there</>;
  if (isArchive(subject)) return <>goes with the request, one subject per file in it</>;
  if (upload) return <>received</>;
  return <progress value={share} max={1} aria-label={`Progress of ${subject.title}`} />;
}
