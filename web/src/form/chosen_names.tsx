/** Some of the surfaces, by name. */
export function ChosenNames(props: {
  label: string;
  names: readonly string[];
  chosen: readonly string[];
  onChosen: (names: string[]) => void;
}) {
  const { chosen, onChosen } = props;
  const names = [...new Set([...props.names, ...chosen])];
  return (
    <fieldset class="row">
      <legend class="hidden-label">{props.label}</legend>
      {names.length === 0 && <p class="muted small">Choose surfaces first.</p>}
      {names.map((name) => (
        <label key={name} class="row small">
          <input
            type="checkbox"
            aria-label={`${props.label}: ${name}`}
            checked={chosen.includes(name)}
            onChange={(event) =>
              onChosen(event.currentTarget.checked ? [...chosen, name] : chosen.filter((one) => one !== name))
            }
          />
          {name}
        </label>
      ))}
    </fieldset>
  );
}
