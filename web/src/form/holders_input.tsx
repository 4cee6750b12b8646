const FOUND = "";
const NOBODY = "(nothing)"; // no name of a surface may have brackets

/** For each surface the one that holds it: found by the server, none, or one of the others. */
export function HoldersInput(props: {
  of: string;
  names: readonly string[];
  holders: Record<string, string | null>;
  onHolders: (holders: Record<string, string | null>) => void;
}) {
  const { holders, onHolders } = props;
  const names = [...new Set([...props.names, ...Object.keys(holders)])];
  return (
    <div class="stack">
      {names.length === 0 && <p class="muted small">Choose surfaces first.</p>}
      {names.map((name) => (
        <label key={name} class="row small">
          {name} is in
          <select
            aria-label={`${props.of}: ${name}`}
            value={name in holders ? (holders[name] ?? NOBODY) : FOUND}
            onChange={(event) => {
              const { [name]: _, ...rest } = holders;
              const chosen = event.currentTarget.value;
              onHolders(chosen === FOUND ? rest : { ...rest, [name]: chosen === NOBODY ? null : chosen });
            }}
          >
            <option value={FOUND}>whichever holds most of it</option>
            <option value={NOBODY}>nothing</option>
            {names
              .filter((one) => one !== name)
              .map((one) => (
                <option key={one}>{one}</option>
              ))}
          </select>
        </label>
      ))}
    </div>
  );
}
