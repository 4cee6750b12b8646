/** Lists longer than one answer of the server. */

export interface Page<T> {
  items: T[];
  /** Of the next page; absent on the last. */
  next?: string | undefined;
}

const MOST_AT_ONCE = 1000;

/** The first `count` of a list, page by page by the server's cursor. */
export async function upTo<T>(count: number, ask: (part: URLSearchParams) => Promise<Page<T>>): Promise<Page<T>> {
  const items: T[] = [];
  let next: string | undefined;
  do {
    const part = new URLSearchParams({ limit: String(Math.min(MOST_AT_ONCE, count - items.length)) });
    if (next) part.set("cursor", next);
    const page = await ask(part);
    items.push(...page.items);
    next = page.next;
  } while (next && items.length < count);
  return { items, next };
}
