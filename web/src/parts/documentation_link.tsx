import { askJson } from "../api/server";
import { useLoaded } from "./loaded";

interface Landing {
  links: { rel: string; href: string }[];
}

/** The foot of the page: the documentation, where this server has it; its landing document says so. */
export function DocumentationLink() {
  const landing = useLoaded("landing", (signal) => askJson<Landing>("/v1", { signal }));
  const told = landing.value?.links.find(({ rel }) => rel === "service-doc"); // who is not answered reads elsewhere why
  return told ? (
    <footer class="foot">
      <a href={new URL(told.href).pathname}>Documentation</a>
    </footer>
  ) : null;
}
