import type { Problem } from "./types";

/** The one way to the server: adds the API key, turns every failure into a `ServerError` people can read. */

const KEY = "integument.key"; // kept for this tab alone, and sent in one header, never in a URL
const PASSING: readonly number[] = [429, 502, 503, 504];

export const KEY_CHANGED = "integument-key-changed";
export const SERVER_AWAY = "integument-server-away";

let keys = 0; // that this tab was given so far

export class ServerError extends Error {
  private readonly keysThen = keys;

  constructor(
    readonly code: string,
    readonly status: number,
    message: string,
    readonly problem: Problem | null = null,
  ) {
    super(message);
  }

  get isAway(): boolean {
    return this.code === "page.server_away";
  }

  /** The same may be answered in a moment. */
  get isPassing(): boolean {
    return this.isAway || PASSING.includes(this.status);
  }

  get wantsKey(): boolean {
    return this.status === 401;
  }

  /** It was refused for want of a key, and there is another one now. */
  get isOfEarlierKey(): boolean {
    return this.wantsKey && this.keysThen !== keys;
  }
}

export function isPassing(error: unknown): boolean {
  return error instanceof ServerError && error.isPassing;
}

export function isOfEarlierKey(error: unknown): boolean {
  return error instanceof ServerError && error.isOfEarlierKey;
}

export function apiKey(): string {
  return sessionStorage.getItem(KEY) ?? "";
}

export function setApiKey(key: string): void {
  if (key) sessionStorage.setItem(KEY, key);
  else sessionStorage.removeItem(KEY);
  keys += 1;
  dispatchEvent(new Event(KEY_CHANGED));
}

/** How many keys this tab was given: what was asked with an earlier one is asked again. */
export function keyCount(): number {
  return keys;
}

export function authorization(): Record<string, string> {
  const key = apiKey();
  return key ? { Authorization: `Bearer ${key}` } : {};
}

export async function ask(path: string, init: RequestInit = {}): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, {
      ...init,
      headers: { ...authorization(), ...(init.headers as Record<string, string>) },
    });
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    dispatchEvent(new Event(SERVER_AWAY));
    throw new ServerError("page.server_away", 0, "The server does not answer.");
  }
  if (!response.ok) throw await errorOf(response);
  return response;
}

export async function askJson<T>(path: string, init: RequestInit = {}): Promise<T> {
  const response = await ask(path, { ...init, headers: { Accept: "application/json", ...(init.headers as object) } });
  return (await response.json()) as T;
}

export function sendJson<T>(path: string, body: unknown, headers: Record<string, string> = {}): Promise<T> {
  return askJson<T>(path, {
    method: "POST",
    body: JSON.stringify(body),
    headers: { "Content-Type": "application/json", ...headers },
  });
}

export async function errorOf(response: Response): Promise<ServerError> {
  try {
    const problem = (await response.json()) as Problem;
    return new ServerError(problem.code, response.status, problem.detail, problem);
  } catch {
    return new ServerError("page.no_problem", response.status, `The server answered ${response.status}.`);
  }
}

export function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
