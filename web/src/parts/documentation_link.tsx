import { useEffect, useState } from "preact/hooks";
import { askJson } from "../api/server";

interface Landing {
  links: { rel: string; href: string }[];
}

/** The foot of the page: the documentation, where this server has it; its landing document says so. */
export function DocumentationLink() {
  const [path, setPath] = useState("");
  useEffect(() => {
    const find = ({ links }: Landing) => {
      const told = links.find(({ rel }) => rel === "service-doc");
      if (told) setPath(new URL(told.href).pathname);
    };
    askJson<Landing>("/v1").then(find, () => setPath("")); // without an answer the page says elsewhere what is wrong
  }, []);
  return path ? (
    <footer class="foot">
      <a href={path}>Documentation</a>
    </footer>
  ) : null;
}
