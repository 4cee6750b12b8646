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
        <option value="system">Theme: auto</option>
        <option value="light">Theme: light</option>
        <option value="dark">Theme: dark</option>
      </select>
    </label>
  );
}
