import { useState } from "preact/hooks";
import { chooseTheme, chosenTheme, type Theme } from "../theme";

export function ThemeChoice() {
  const [theme, setTheme] = useState(chosenTheme);
  return (
    <label>
      <span class="hidden-label">Colours of the page</span>
      <select
        value={theme}
        onChange={(event) => {
          const chosen = event.currentTarget.value as Theme;
          chooseTheme(chosen);
          setTheme(chosen);
        }}
      >
        <option value="system">Auto</option>
        <option value="light">Light</option>
        <option value="dark">Dark</option>
      </select>
    </label>
  );
}
