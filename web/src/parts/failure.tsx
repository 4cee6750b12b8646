import { isOfEarlierKey, messageOf, ServerError } from "../api/server";
import { useKeyCount } from "./key_count";
import { wantKey } from "./key_dialog";

/** An error as people read it: what happened, its stable code, and what can be done from here. */
export function Failure({ error, again }: { error: unknown; again?: (() => void) | undefined }) {
  useKeyCount();
  if (isOfEarlierKey(error)) return null;
  const problem = error instanceof ServerError ? error.problem : null;
  return (
    <div class="note bad stack" role="alert">
      <p>
        {messageOf(error)} {problem && <span class="mono">{problem.code}</span>}
      </p>
      {problem?.findings?.map((finding) => (
        <p key={finding.code + finding.message} class="small">
          {finding.message}
        </p>
      ))}
      <div class="row">
        {error instanceof ServerError && error.wantsKey && (
          <button type="button" onClick={wantKey}>
            Enter an API key
          </button>
        )}
        {again && (
          <button type="button" onClick={again}>
            Try again
          </button>
        )}
      </div>
    </div>
  );
}
