"""The cheapest way to cut a graph in two."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

Ints = NDArray[np.int64]

SOURCE, SINK = 0, 1  # nodes that end up on different sides
UNLIMITED = 2**30


def cut_in_two(count: int, first: Ints, second: Ints, cost: Ints) -> NDArray[np.bool_]:
    """True for the nodes (count,) on the side of the source, where the links cut between the sides cost least together.

    first, second: (L,) nodes of each link, whichever way; cost: (L,) whole numbers above 0. Of several cheapest cuts the one
    next to the source. Source: maximum flow by Dinitz' algorithm (scipy)."""
    linked = first != second
    ends = np.column_stack((first[linked], second[linked]))
    both = np.concatenate((ends, ends[:, ::-1]))
    graph = coo_array((np.tile(cost[linked], 2), (both[:, 0], both[:, 1])), shape=(count, count)).tocsr()
    graph.data = np.minimum(graph.data, UNLIMITED).astype(np.int32)
    left = graph - maximum_flow(graph, SOURCE, SINK).flow
    left.data = np.maximum(left.data, 0)
    left.eliminate_zeros()
    reached = np.zeros(count, dtype=np.bool_)
    reached[breadth_first_order(left, SOURCE, return_predecessors=False)] = True
    return reached
