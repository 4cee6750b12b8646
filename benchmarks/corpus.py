"""The robustness corpus as a table."""

from __future__ import annotations

from benchmarks.table import percent, print_table, thousands
from subjects.corpus import CORPUS, Subject
from subjects.trial import Trial, attempt

HEAD = ("subject", "layers mm", "faces", "outcome", "seconds", "on target", "smallest gap mm", "min q")


def run_corpus(costs: set[str]) -> bool:
    """Every subject of these costs; True if each ended as it must and no promise was broken."""
    chosen = [subject for subject in CORPUS if subject.cost in costs]
    ended: list[bool] = []

    def attempted(subject: Subject) -> tuple[str, ...]:
        trial = attempt(subject.make(), subject.depths_mm)
        ended.append(subject.is_right(trial))
        return _row(subject, trial)

    print_table(f"Robustness: {len(chosen)} subjects", HEAD, map(attempted, chosen))
    print(f"{sum(ended)} of {len(ended)} ended as they must.")
    return all(ended)


def _row(subject: Subject, trial: Trial) -> tuple[str, ...]:
    wrong = f"**not {subject.expected}: {trial.outcome}** {'; '.join(trial.broken)}"
    return (
        subject.name,
        "/".join(f"{depth:g}" for depth in subject.depths_mm),
        thousands(trial.faces),
        trial.outcome if subject.is_right(trial) else wrong,
        f"{trial.seconds:.1f}",
        percent(trial.on_target, 1) or "-",
        "-" if trial.min_gap_mm is None else f"{trial.min_gap_mm:.3f}",
        "-" if trial.min_quality is None else f"{trial.min_quality:.3f}",
    )
