import { useEffect, useRef } from "preact/hooks";
import icon from "./icon.svg";
import { CohortPage } from "./pages/cohort";
import { CohortsPage } from "./pages/cohorts";
import { ComparePage } from "./pages/compare";
import { JobPage } from "./pages/job";
import { JobsPage } from "./pages/jobs";
import { MeshesPage } from "./pages/meshes";
import { NewJobPage } from "./pages/new_job";
import { UnlessBroken } from "./parts/broken_page";
import { DocumentationLink } from "./parts/documentation_link";
import { KeyDialog, useKeyDialog } from "./parts/key_dialog";
import { ServerBanner, useServerState } from "./parts/server_state";
import { ThemeChoice } from "./parts/theme_choice";
import { type Place, usePlace } from "./router";

const NAVIGATION = [
  ["", "Meshes"],
  ["new", "New job"],
  ["jobs", "Jobs"],
  ["cohorts", "Cohorts"],
] as const;

function Body({ place, form }: { place: Place; form: string }) {
  switch (place.path[0]) {
    case undefined:
      return <MeshesPage chosenId={place.query.get("mesh") ?? undefined} />;
    case "new":
      return <NewJobPage query={place.query} key={form} />;
    case "jobs":
      return place.path[1] ? (
        <JobPage id={place.path[1]} />
      ) : (
        <JobsPage place={place.query} key={place.query.get("label") ?? ""} />
      );
    case "cohorts":
      return place.path[1] ? <CohortPage id={place.path[1]} key={place.path[1]} /> : <CohortsPage />;
    case "compare":
      return <ComparePage a={place.query.get("a") ?? ""} b={place.query.get("b") ?? ""} />;
    default:
      return (
        <div class="card empty">
          <h1>There is no such page</h1>
          <p>
            <a href="#/">Back to the meshes</a>
          </p>
        </div>
      );
  }
}

export function Page() {
  const place = usePlace();
  const server = useServerState();
  const key = useKeyDialog();
  const main = useRef<HTMLElement>(null);
  const here = place.path[0] ?? "";
  // a link with settings begins a form anew; one without leaves what was typed
  const form = useRef("");
  if (here === "new" && place.query.size > 0) form.current = place.query.toString();
  useEffect(() => {
    document.title = `${NAVIGATION.find(([path]) => path === here)?.[1] ?? "Integument"} · Integument`;
  }, [here]);
  // who goes on by keyboard or by ear goes on at the new page, not in the header again
  const there = place.path.join("/");
  const first = useRef(there);
  useEffect(() => {
    if (there !== first.current) main.current?.focus({ preventScroll: true });
    first.current = there;
  }, [there]);
  return (
    <>
      <button type="button" class="skip" onClick={() => main.current?.focus()}>
        Skip to the content
      </button>
      <header class="bar">
        <a class="brand" href="#/">
          <img src={icon} alt="" />
          Integument
        </a>
        <nav aria-label="Pages">
          {NAVIGATION.map(([path, title]) => (
            <a key={path} href={`#/${path}`} {...(here === path ? { "aria-current": "page" as const } : {})}>
              {title}
            </a>
          ))}
        </nav>
        <div class="tools">
          <button type="button" class="quiet" onClick={key.open}>
            API key
          </button>
          <ThemeChoice />
        </div>
      </header>
      <ServerBanner state={server} />
      <main ref={main} tabIndex={-1}>
        <UnlessBroken key={there}>
          <Body place={place} form={form.current} />
        </UnlessBroken>
      </main>
      <DocumentationLink />
      <KeyDialog {...key} />
    </>
  );
}
