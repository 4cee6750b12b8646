/** What people call a job or a cohort, as it is typed: labels are separated by commas. */
export interface TypedWords {
  name: string;
  labels: string;
}

export const NO_WORDS: TypedWords = { name: "", labels: "" };

export function listLabels(typed: string): string[] {
  return typed.split(",").flatMap((label) => label.trim() || []);
}

/** As the server takes them with a request. */
export function sentWords({ name, labels }: TypedWords): { name?: string; labels?: string[] } {
  const listed = listLabels(labels);
  return { ...(name.trim() ? { name: name.trim() } : {}), ...(listed.length > 0 ? { labels: listed } : {}) };
}

export function WordsInputs({ words, onWords }: { words: TypedWords; onWords: (words: TypedWords) => void }) {
  return (
    <>
      <label class="field">
        Name
        <input
          value={words.name}
          maxLength={200}
          onInput={(event) => onWords({ ...words, name: event.currentTarget.value })}
        />
      </label>
      <label class="field">
        Labels, separated by commas
        <input value={words.labels} onInput={(event) => onWords({ ...words, labels: event.currentTarget.value })} />
      </label>
    </>
  );
}
