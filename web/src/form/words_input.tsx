/** Words between commas; none leaves the input out. */
export function WordsInput(props: {
  id: string;
  words: readonly string[];
  onWords: (words: string[] | undefined) => void;
}) {
  return (
    <input
      id={props.id}
      class="wide"
      value={props.words.join(", ")}
      placeholder="separated by commas"
      onChange={(event) => {
        const words = event.currentTarget.value.split(",").flatMap((word) => word.trim() || []);
        props.onWords(words.length > 0 ? words : undefined);
      }}
    />
  );
}
