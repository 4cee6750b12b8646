import type { Problem } from "./types";

/** The one way to the server: adds the API key, turns every failure into a `ServerError` people can read. */

const KEY = "integument.key"; // kept for this tab alone, and sent in one header, never in a URL

export class ServerError extends Error {
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

  get wantsKey(): boolean {
    return this.status === 401;
  }
}

export function apiKey(): string {
  return sessionStorage.getItem(KEY) ?? "";
}

export function setApiKey(key: string): void {
  if (key) sessionStorage.setItem(KEY, key);
  else sessionStorage.removeItem(KEY);
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
