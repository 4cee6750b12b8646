import { DetailedError, Upload } from "tus-js-client";
import { authorization, messageOf, ServerError, sendJson } from "./server";
import type { MeshInfo, Unit } from "./types";

/** Files in pieces (tus): what arrived stays, also when the network or this page goes away in between. */

export interface Sending {
  /** The address of the finished upload. */
  done: Promise<string>;
  stop: () => void;
}

const PIECE_BYTES = 32 * 1024 * 1024;
const PAUSES_MS = [0, 500, 1500, 3000, 5000, 10_000, 20_000];

export function sendFile(file: File, onProgress: (share: number) => void): Sending {
  let stop = () => {};
  const done = new Promise<string>((resolve, reject) => {
    const upload = new Upload(file, {
      endpoint: "/v1/uploads",
      chunkSize: PIECE_BYTES,
      retryDelays: PAUSES_MS,
      metadata: { filename: file.name },
      removeFingerprintOnSuccess: true,
      onBeforeRequest: (request) => {
        // of now: the key may be another one by the next piece
        for (const [name, value] of Object.entries(authorization())) request.setHeader(name, value);
      },
      onProgress: (sent, total) => onProgress(total ? sent / total : 0),
      onSuccess: () => resolve(new URL(upload.url!, location.href).pathname),
      onError: (error) => reject(uploadError(error)),
    });
    stop = () => {
      void upload.abort();
      reject(new DOMException("stopped", "AbortError"));
    };
    void upload.findPreviousUploads().then((earlier) => {
      if (earlier[0]) upload.resumeFromPreviousUpload(earlier[0]);
      upload.start();
    });
  });
  return { done, stop: () => stop() };
}

/** Read a finished upload as a mesh. */
export function makeMesh(uploadPath: string, unit: Unit): Promise<MeshInfo> {
  return sendJson<MeshInfo>(`${uploadPath}/mesh`, { unit });
}

function uploadError(error: Error | DetailedError): Error {
  const reply = error instanceof DetailedError ? error.originalResponse : null;
  if (!reply) return new ServerError("page.server_away", 0, `The upload broke off. ${messageOf(error).split("\n")[0]}`);
  try {
    const problem = JSON.parse(reply.getBody());
    return new ServerError(problem.code, reply.getStatus(), problem.detail, problem);
  } catch {
    return new ServerError("page.no_problem", reply.getStatus(), `The server answered ${reply.getStatus()}.`);
  }
}
