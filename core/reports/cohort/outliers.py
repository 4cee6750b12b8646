"""Numbers that lie far from those of the other subjects, told by median and median absolute deviation.

Both stay where they are however far a few numbers lie, so one giant hides no other. Source: Iglewicz & Hoaglin, How to Detect and
Handle Outliers, ASQC Quality Press, 1993: modified z above 3.5; the mean deviation where half of the numbers are equal."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import fmean, median

from core.schema.cohort import ColumnSummary, Outlier

FEWEST = 5  # of fewer numbers nobody can tell what is usual
FAR = 3.5
NORMAL_OF_MEDIAN_DEVIATION = 1.4826  # both make a standard deviation of what they are multiplied with, for normal numbers
NORMAL_OF_MEAN_DEVIATION = 1.2533
ROUNDING = 1e-6  # of the median: what float32 files and sums in another order may differ by
METHODS = (
    f"A number is marked when it lies more than {FAR} robust deviations from the median of all subjects that have it, of at "
    f"least {FEWEST}: the median absolute deviation times {NORMAL_OF_MEDIAN_DEVIATION}, or where that is zero the mean absolute "
    f"deviation from the median times {NORMAL_OF_MEAN_DEVIATION} (Iglewicz and Hoaglin, 1993). Differences below {ROUNDING:g} of "
    "the median are rounding. Subjects without a report have no numbers and are no outliers."
)


def summarize_column(values: Mapping[str, float]) -> ColumnSummary:
    """Of one number at least."""
    told = list(values.values())
    middle = median(told)
    spread = NORMAL_OF_MEDIAN_DEVIATION * median(abs(value - middle) for value in told)
    return ColumnSummary(count=len(told), minimum=min(told), median=middle, maximum=max(told), spread=spread)


def find_outliers(column: str, values: Mapping[str, float]) -> list[Outlier]:
    """Subject -> number. In the order of the subjects."""
    if len(values) < FEWEST:
        return []
    middle = median(values.values())
    deviations = [abs(value - middle) for value in values.values()]
    unit = NORMAL_OF_MEDIAN_DEVIATION * median(deviations) or NORMAL_OF_MEAN_DEVIATION * fmean(deviations)
    least = ROUNDING * abs(middle)
    return [
        _outlier(subject, column, value, middle, (value - middle) / unit, len(values))
        for subject, value in values.items()
        if abs(value - middle) > max(FAR * unit, least)
    ]


def _outlier(subject: str, column: str, value: float, middle: float, z: float, count: int) -> Outlier:
    side = "above" if z > 0 else "below"
    reason = f"{column} is {value:.6g}, {abs(z):.1f} robust deviations {side} the median {middle:.6g} of {count} subjects"
    return Outlier(subject=subject, column=column, value=value, median=middle, deviations=round(z, 2), reason=reason)
