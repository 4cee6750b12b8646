import { listCohorts } from "../api/cohorts";
import { Failure } from "../parts/failure";
import { MoreButton, useLongList } from "../parts/long_list";
import { NewCohort } from "../parts/new_cohort";
import { sayWhen } from "../words";

const FIRST = 50;

/** Studies of many subjects: those there are, and a new one. */
export function CohortsPage() {
  const list = useLongList("cohorts", listCohorts, FIRST);
  return (
    <>
      <div class="heading">
        <h1>Cohorts</h1>
      </div>
      {list.error ? <Failure error={list.error} again={list.again} /> : null}
      {list.loading && !list.known && <p class="empty">Loading…</p>}
      {list.known && list.items.length === 0 && (
        <p class="card empty">No cohorts yet. A cohort is one job for many meshes.</p>
      )}
      {list.items.length > 0 && (
        <div class="card scroll-x">
          <table>
            <thead>
              <tr>
                <th>Cohort</th>
                <th>Process</th>
                <th>Status</th>
                <th class="number">Subjects</th>
                <th class="number">Ready</th>
                <th class="number">Failed</th>
                <th>Created</th>
              </tr>
            </thead>
            <tbody>
              {list.items.map((one) => (
                <tr key={one.id}>
                  <td>
                    <a href={`#/cohorts/${one.id}`}>{one.name ?? one.id.slice(0, 8)}</a>
                  </td>
                  <td>{one.processID}</td>
                  <td>{one.status === "finished" ? "finished" : `${one.status} ${one.progress} %`}</td>
                  <td class="number">{one.subjects}</td>
                  <td class="number">{one.ready}</td>
                  <td class="number">{one.counts.failed + one.counts.refused}</td>
                  <td>{sayWhen(one.created)}</td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
      <MoreButton onMore={list.showMore} loading={list.loading} />
      <NewCohort />
    </>
  );
}
