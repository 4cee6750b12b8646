import { type Cohort, listCohorts } from "../api/cohorts";
import { Failure } from "../parts/failure";
import { MoreButton, useLongList } from "../parts/long_list";
import { NewCohort } from "../parts/new_cohort";
import { type Column, Table } from "../parts/table";
import { sayCount, sayWhen } from "../words";

const FIRST = 50;
const COLUMNS: readonly Column<Cohort>[] = [
  { title: "Cohort", cell: (one) => <a href={`#/cohorts/${one.id}`}>{one.name ?? one.id.slice(0, 8)}</a> },
  { title: "Process", cell: (one) => one.processID },
  {
    title: "Status",
    cell: (one) => (one.status === "finished" ? one.status : `${one.status} ${one.progress} %`),
  },
  { title: "Subjects", kind: "number", cell: (one) => sayCount(one.subjects) },
  { title: "Ready", kind: "number", cell: (one) => sayCount(one.ready) },
  { title: "Failed", kind: "number", cell: (one) => sayCount(one.counts.failed + one.counts.refused) },
  { title: "Created", cell: (one) => sayWhen(one.created) },
];

/** Studies of many subjects: those there are, and a new one. */
export function CohortsPage() {
  const list = useLongList("cohorts", listCohorts, FIRST);
  return (
    <>
      <div class="heading">
        <h1>Cohorts</h1>
      </div>
      <div class="stack">
        {list.error ? <Failure error={list.error} again={list.again} /> : null}
        {list.loading && !list.known && <p class="empty">Loading…</p>}
        {list.known && list.items.length === 0 && (
          <p class="card empty">No cohorts yet. A cohort is one job for many meshes.</p>
        )}
        {list.items.length > 0 && (
          <section class="card" aria-label="All cohorts">
            <Table rows={list.items} keyOf={(one) => one.id} columns={COLUMNS} />
          </section>
        )}
        <MoreButton onMore={list.showMore} loading={list.loading} />
        <NewCohort />
      </div>
    </>
  );
}
