import { messageOf } from "../api/server";
import { RemoveButton, RemoveHeading } from "../form/remove_button";
import { sayLength } from "../units";
import { sayBytes, sayContent } from "../words";
import type { Subject } from "./subject";
import { isArchive } from "./subject";

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
    <div class="scroll-x">
      <table>
        <thead>
          <tr>
            <th>Subject</th>
            <th>Size</th>
            <th>State</th>
            <RemoveHeading />
          </tr>
        </thead>
        <tbody>
          {subjects.map((one) => (
            <tr key={one.number}>
              <td class="name">{one.title}</td>
              <td class="small">{sizeOf(one)}</td>
              <td class="small">
                <State subject={one} />
              </td>
              <td>
                <RemoveButton what={one.title} onRemove={() => onRemove(one.number)} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
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
