import { useEffect, useState } from "preact/hooks";

const PATIENCE_MS = 4000;

/** For what cannot be taken back: the first click asks, the second one does it. */
export function ConfirmedButton(props: { label: string; about: string; disabled?: boolean; onConfirmed: () => void }) {
  const [asked, setAsked] = useState(false);
  useEffect(() => {
    if (!asked) return;
    const timer = setTimeout(() => setAsked(false), PATIENCE_MS);
    return () => clearTimeout(timer);
  }, [asked]);
  return (
    <button
      type="button"
      class="quiet danger"
      disabled={props.disabled ?? false}
      aria-label={asked ? `Yes, ${props.about}` : props.about}
      onClick={() => {
        setAsked(!asked);
        if (asked) props.onConfirmed();
      }}
    >
      {asked ? "Sure? Click again" : props.label}
    </button>
  );
}
