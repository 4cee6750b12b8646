import { useEffect, useState } from "preact/hooks";
import { KEY_CHANGED, keyCount } from "../api/server";

/** Changes with the key of this tab: what depends on it asks again, and nothing that was typed is lost. */
export function useKeyCount(): number {
  const [count, setCount] = useState(keyCount);
  useEffect(() => {
    const follow = () => setCount(keyCount());
    addEventListener(KEY_CHANGED, follow);
    return () => removeEventListener(KEY_CHANGED, follow);
  }, []);
  return count;
}
