import { render } from "preact";
import { Page } from "./page";
import { applyTheme, chosenTheme } from "./theme";

applyTheme(chosenTheme());
render(<Page />, document.getElementById("page")!);
