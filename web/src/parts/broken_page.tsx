import type { ComponentChildren } from "preact";
import { useErrorBoundary } from "preact/hooks";
import { messageOf } from "../api/server";

/** Where a page cannot be drawn, by a fault of ours, it says so instead of standing there half. */
export function UnlessBroken({ children }: { children: ComponentChildren }) {
  const [error, mend] = useErrorBoundary((reason) => reportError(reason));
  if (!error) return <>{children}</>;
  return (
    <div class="card empty" role="alert">
      <h1>This page cannot be shown</h1>
      <p>The fault is the page's own: {messageOf(error)}. Nothing on the server was changed by it.</p>
      <p class="row">
        <button type="button" onClick={mend}>
          Try again
        </button>
        <a class="button" href="#/jobs">
          To the jobs
        </a>
      </p>
    </div>
  );
}
