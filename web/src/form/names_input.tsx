/** A name for each label of a volume; labels of one name become one surface, one that is left empty has none. */
export function NamesInput(props: {
  of: string;
  names: Record<string, string>;
  labels: readonly number[];
  onNames: (names: Record<string, string>) => void;
}) {
  const { names, onNames } = props;
  const labels = [...new Set([...props.labels.map(String), ...Object.keys(names)])];
  return (
    <div class="stack">
      {labels.length === 0 && <p class="muted small">Choose a volume to see its labels.</p>}
      {labels.map((label) => (
        <label key={label} class="row small">
          {label}
          <input
            aria-label={`${props.of}: name of label ${label}`}
            value={names[label] ?? ""}
            placeholder={`label_${label}`}
            onInput={(event) => {
              const { [label]: _, ...rest } = names;
              const name = event.currentTarget.value.trim();
              onNames(name ? { ...rest, [label]: name } : rest);
            }}
          />
        </label>
      ))}
    </div>
  );
}
