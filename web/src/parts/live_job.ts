import { useEffect, useState } from "preact/hooks";
import { followJob } from "../api/events";
import { getJob, isOver } from "../api/jobs";
import { isPassing } from "../api/server";
import type { Job } from "../api/types";
import { useKeyCount } from "./key_count";

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
const AGAIN_MS = 2000;

/** A job as it goes on: its events one by one, through restarts of the server. What was seen stays where it cannot go on. */
export function useLiveJob(id: string): LiveJob {
  const [job, setJob] = useState<Job | null>(null);
  const [error, setError] = useState<unknown>(null);
  const [log, setLog] = useState<LogLine[]>([]);
  const [connected, setConnected] = useState(true);
  const [turn, setTurn] = useState(0);
  const keys = useKeyCount();
  useEffect(() => {
    const aborter = new AbortController();
    let timer = 0;
    const follow = async () => {
      try {
        setJob(await getJob(id, aborter.signal));
        setError(null);
        setLog([]); // all of it is told again
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
        if (aborter.signal.aborted) return;
        setError(reason);
        if (isPassing(reason)) timer = window.setTimeout(follow, AGAIN_MS);
      }
    };
    void follow();
    return () => {
      aborter.abort();
      clearTimeout(timer);
    };
  }, [id, turn, keys]);
  return { job: job?.jobID === id ? job : null, error, log, connected, again: () => setTurn(turn + 1) };
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
