"""The summary of a cohort: one line per subject, what is usual, and what is not."""
