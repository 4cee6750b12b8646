import { useEffect, useState } from "preact/hooks";
import { followJob } from "../api/events";
import { getJob, isOver } from "../api/jobs";
import type { Job } from "../api/types";

export interface LogLine {
  at: string;
  text: string;
}

export interface LiveJob {
  job: Job | null;
  error: unknown;
  log: LogLine[];
  connected: boolean;
  again: () => void;
}

const MOST_LINES = 400;

/** A job as it goes on: its events one by one, through restarts of the server. */
export function useLiveJob(id: string): LiveJob {
  const [job, setJob] = useState<Job | null>(null);
  const [error, setError] = useState<unknown>(null);
  const [log, setLog] = useState<LogLine[]>([]);
  const [connected, setConnected] = useState(true);
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const aborter = new AbortController();
    setJob(null);
    setLog([]);
    setError(null);
    void (async () => {
      try {
        const first = await getJob(id, aborter.signal);
        setJob(first);
        await followJob(
          id,
          ({ type, data }) => {
            const text = [data.phase, data.message].filter(Boolean).join(": ");
            if (text) setLog((lines) => [...lines, { at: String(data.at ?? ""), text }].slice(-MOST_LINES));
            if (type !== "log") setJob((before) => (before && !isOver(before) ? merged(before, data) : before));
          },
          setConnected,
          aborter.signal,
        );
        setJob(await getJob(id, aborter.signal));
      } catch (reason) {
        if (!aborter.signal.aborted) setError(reason);
      }
    })();
    return () => aborter.abort();
  }, [id, turn]);
  return { job, error, log, connected, again: () => setTurn(turn + 1) };
}

/** Events tell what changed; a status that says the job is over is believed only of the job itself. */
function merged(job: Job, data: Record<string, unknown>): Job {
  const status = data.status === "running" || data.status === "accepted" ? data.status : job.status;
  return {
    ...job,
    status,
    progress: typeof data.progress === "number" ? Math.floor(data.progress) : job.progress,
    phase: typeof data.phase === "string" && data.phase ? data.phase : (job.phase ?? ""),
    message: typeof data.message === "string" && data.message ? data.message : job.message,
  };
}
