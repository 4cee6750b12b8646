import { ask } from "../api/server";

/** Files for the user's disk. Through fetch, since a plain link cannot carry the API key. */

export function saveBlob(blob: Blob, fileName: string): void {
  const url = URL.createObjectURL(blob);
  const link = document.createElement("a");
  link.href = url;
  link.download = fileName;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

export async function saveFrom(path: string, fileName: string, accept?: string): Promise<void> {
  const reply = await ask(path, accept ? { headers: { Accept: accept } } : {});
  saveBlob(await reply.blob(), fileName);
}
