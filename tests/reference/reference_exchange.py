"""An exchange between two rows of triples, as a sum over all ways in which cells may be swapped, for a few sizes.

The laws are indexed [b, a, c] for the centre b between a and c. A grain A of the lower row and a grain B of the upper
one change places with the probability q(A, B); where they are of one size, nothing changes.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def probabilities(sizes: Floats, mixing: float, segregation: float) -> Floats:
    """(N, N) q[A, B]; segregation is Q for a unit of size by which the lower grain A is the larger."""
    q = segregation * np.maximum(sizes[:, None] - sizes[None, :], 0.0)
    found: Floats = mixing + q - 0.5 * q**2
    np.fill_diagonal(found, 0.0)
    return found


def exchanged(own: Floats, partner: Floats, q: Floats) -> Floats:
    """Law of a row after an exchange with a row whose law of three adjacent partners is given.

    `q[x, y]` is the probability that x of this row changes places with y of the other.
    """
    nodes = range(own.shape[0])
    after = np.zeros_like(own)
    for cells in product(nodes, repeat=3):
        for others in product(nodes, repeat=3):
            together = own[cells] * partner[others]
            if together == 0.0:
                continue
            for swapped in product((False, True), repeat=3):
                chance, new = together, []
                for mine, theirs, swap in zip(cells, others, swapped, strict=True):
                    chance *= q[mine, theirs] if swap else 1.0 - q[mine, theirs]
                    new.append(theirs if swap else mine)
                after[tuple(new)] += chance
    return after


def independent(law: Floats) -> Floats:
    """(N, N, N) three partners that have nothing to do with each other, of the sizes in a row."""
    share = law.sum(axis=(1, 2))
    found: Floats = np.einsum("b,a,c->bac", share, share, share)
    return found
