// One upload by tus-js-client: node tus_client.mjs '{"modules", "endpoint", "file", "metadata", "chunk", "abortAt", "memory", "headers", "terminate"}'
// Prints one JSON object: {"url", "sent", "resumedFrom", "error", "retries"}.
import { createReadStream, statSync } from 'node:fs';
import { createRequire } from 'node:module';

const given = JSON.parse(process.argv[2]);
const { Upload, FileUrlStorage } = createRequire(`${given.modules}/`)('tus-js-client');
const size = statSync(given.file).size;
const told = { url: null, sent: 0, resumedFrom: null, error: null, retries: 0 };
const say = () => {
  told.url = upload.url;
  console.log(JSON.stringify(told));
};

const upload = new Upload(createReadStream(given.file), {
  endpoint: given.endpoint,
  headers: given.headers ?? {},
  metadata: given.metadata ?? {},
  uploadSize: size,
  chunkSize: given.chunk,
  retryDelays: given.retryDelays ?? [200, 500, 1000, 1000, 2000, 2000, 4000, 4000, 8000, 8000],
  urlStorage: new FileUrlStorage(given.memory),
  fingerprint: async () => `tests-${size}`,
  onShouldRetry: () => {
    told.retries += 1;
    return true;
  },
  onChunkComplete: async (_length, accepted) => {
    told.sent = accepted;
    if (given.abortAt && accepted >= given.abortAt) {
      await upload.abort(given.terminate ?? false);
      say();
      process.exit(0);
    }
  },
  onError: (error) => {
    told.error = String(error);
    say();
    process.exit(1);
  },
  onSuccess: say,
});

const [previous] = await upload.findPreviousUploads();
if (previous) {
  upload.resumeFromPreviousUpload(previous);
  const answer = await fetch(previous.uploadUrl, {
    method: 'HEAD',
    headers: { 'Tus-Resumable': '1.0.0', ...(given.headers ?? {}) },
  });
  told.resumedFrom = Number(answer.headers.get('Upload-Offset'));
}
upload.start();
