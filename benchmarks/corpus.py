"""The robustness corpus as a table."""

from __future__ import annotations

from benchmarks.table import percent, print_table, thousands
from subjects.corpus import CORPUS
from subjects.trial import attempt

HEAD = ("subject", "layers mm", "faces", "outcome", "seconds", "on target", "smallest gap mm", "min q")


def run_corpus(costs: set[str]) -> bool:
    """Every subject of these costs; True if each ended as expected and no promise was broken."""
    rows, right = [], True
    for subject in CORPUS:
        if subject.cost not in costs:
            continue
        trial = attempt(subject.make(), subject.depths_mm)
        as_expected = subject.is_right(trial)
        right = right and as_expected
        outcome = trial.outcome if as_expected else f"**{trial.outcome}** {'; '.join(trial.broken)}"
        rows.append(
            (
                subject.name,
                "/".join(f"{depth:g}" for depth in subject.depths_mm),
                thousands(trial.faces),
                outcome,
                f"{trial.seconds:.1f}",
                percent(trial.on_target, 1) or "-",
                "-" if trial.min_gap_mm is None else f"{trial.min_gap_mm:.3f}",
                "-" if trial.min_quality is None else f"{trial.min_quality:.3f}",
            )
        )
    print_table(f"Robustness: {len(rows)} subjects", HEAD, rows)
    return right
