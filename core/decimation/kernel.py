"""How the kernels of decimation are compiled."""

from __future__ import annotations

from numba import njit

# Without reference counts: these kernels get all arrays from their callers and make none (numba refuses to compile one that
# would), and they hand many arrays to each other, millions of times. Counting cost a third of the time.
kernel = njit(cache=True, nogil=True, _nrt=False)
