import { useRef, useState } from "preact/hooks";

const KINDS = ".stl,.mat,.ply,.obj,.nii,.nii.gz,.gz,.mgz,.mgh,.msh,.csv,.tsv,.txt,.dat,.ccd,.tcd";

/** Where files land: by dragging, or by the usual dialog. */
export function DropZone({
  onFiles,
  small = false,
  archives = false,
}: {
  onFiles: (files: File[]) => void;
  small?: boolean;
  /** Whether a zip of them is taken, too. */
  archives?: boolean;
}) {
  const [over, setOver] = useState(false);
  const input = useRef<HTMLInputElement>(null);
  return (
    <section
      class={`drop${over ? " over" : ""}${small ? " small" : ""}`}
      aria-label="Upload"
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        onFiles([...(event.dataTransfer?.files ?? [])]);
      }}
    >
      {!small && (
        <svg viewBox="0 0 24 24" fill="none" stroke="currentColor" stroke-width="1.4" aria-hidden="true">
          <path d="M12 15V4m0 0L8 8m4-4 4 4M4 15v3a2 2 0 0 0 2 2h12a2 2 0 0 0 2-2v-3" />
        </svg>
      )}
      {!small && <h2>Drop the surface of a body here</h2>}
      <div class="row">
        <button type="button" class="primary" onClick={() => input.current?.click()}>
          Choose files…
        </button>
        <span class="muted">
          or drop them: STL, MAT, PLY, OBJ, NIfTI, MGZ, fields, coils{archives && ", or one zip of them"}
        </span>
      </div>
      <input
        ref={input}
        class="hidden-label"
        type="file"
        multiple
        accept={archives ? `${KINDS},.zip` : KINDS}
        tabIndex={-1}
        aria-label="Files to upload"
        onChange={(event) => {
          onFiles([...(event.currentTarget.files ?? [])]);
          event.currentTarget.value = "";
        }}
      />
    </section>
  );
}
