import { expect, test } from "vitest";
import { EventParser } from "../src/api/events";

const STREAM =
  ': events of a job\nretry: 3000\n\nevent: status\ndata: {"status": "running"}\nid: 2\n\nevent: done\ndata: {"a": 1}\nid: 3\n\n';

test("events come out whole, however the stream is cut", () => {
  for (let size = 1; size < STREAM.length; size++) {
    const parser = new EventParser();
    const events = [];
    for (let start = 0; start < STREAM.length; start += size)
      events.push(...parser.push(STREAM.slice(start, start + size)));
    expect(events).toEqual([
      { type: "status", id: "2", data: { status: "running" } },
      { type: "done", id: "3", data: { a: 1 } },
    ]);
  }
});
