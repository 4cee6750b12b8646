import { useEffect, useRef, useState } from "preact/hooks";
import { apiKey, setApiKey } from "../api/server";

export const KEY_WANTED = "integument-key-wanted";

/** Anything that was refused for want of a key calls this; the dialog opens once. */
export function wantKey(): void {
  dispatchEvent(new Event(KEY_WANTED));
}

export function useKeyDialog() {
  const [shown, setShown] = useState(false);
  const open = () => setShown(true);
  useEffect(() => {
    addEventListener(KEY_WANTED, open);
    return () => removeEventListener(KEY_WANTED, open);
  }, []);
  const close = (key: string | null) => {
    setShown(false);
    if (key !== null) setApiKey(key);
  };
  return { shown, open, close };
}

export function KeyDialog({ shown, close }: { shown: boolean; close: (key: string | null) => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const input = useRef<HTMLInputElement>(null);
  useEffect(() => {
    if (shown && !dialog.current?.open) {
      dialog.current?.showModal();
      if (input.current) input.current.value = apiKey();
    }
    if (!shown) dialog.current?.close();
  }, [shown]);
  return (
    <dialog ref={dialog} aria-labelledby="key-title" onClose={() => shown && close(null)}>
      <form
        class="stack"
        onSubmit={(event) => {
          event.preventDefault();
          close(input.current?.value.trim() ?? "");
        }}
      >
        <h2 id="key-title">API key</h2>
        <p class="muted">
          Needed where the server asks for keys. It stays in this tab, until the tab is closed, and is sent in one
          header.
        </p>
        <div class="field">
          <label for="key">Key</label>
          <input id="key" ref={input} type="password" autocomplete="off" spellcheck={false} placeholder="itg_…" />
        </div>
        <div class="row end">
          <button type="button" onClick={() => close(null)}>
            Cancel
          </button>
          <button type="submit" class="primary">
            Use this key
          </button>
        </div>
      </form>
    </dialog>
  );
}
