"""The linear-mixture packing model of Yu & Standish.

A. B. Yu, N. Standish, Ind. Eng. Chem. Res. 30 (1991) 1372; A. B. Yu, R. P. Zou, N. Standish, ibid. 35 (1996) 3730;
window of R. M. Frings, M. G. Kleinhans, S. Vollmer, Sedimentology 55 (2008) 1571.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
WINDOW = 0.154  # size ratio down to which grains mix rather than fill
MIXING = 0.741  # size ratio from which on they pack as one
MOST_CLASSES = 100  # the cost grows as the cube


def _quadratic(ratio: Floats) -> Floats:
    shape = -1.0002 + 0.1126 * ratio + 5.8455 * ratio**2 - 7.9488 * ratio**3 + 3.1222 * ratio**4
    return np.where(ratio > MIXING, 0.0, 10.288 * shape)


def _cubic(ratio: Floats) -> Floats:
    shape = -1.0029 + 0.3589 * ratio + 10.970 * ratio**2 - 22.197 * ratio**3 + 12.434 * ratio**4
    return np.where(ratio > MIXING, 0.0, shape)


def mixing_fraction(size: Floats, share: Floats, packing: Floats) -> float:
    """Solid fraction of classes: the largest specific volume among those of all classes that may decide.

    Parameters
    ----------
    size, share : ndarray (N,)
        Classes that hold grains.
    packing : ndarray (N,)
        Solid fraction of each size alone.
    """
    order = np.argsort(size)
    size, share, volume = size[order], share[order], 1.0 / packing[order]
    ratio = np.minimum(size[:, None], size[None, :]) / np.maximum(size[:, None], size[None, :])
    quadratic, cubic = _quadratic(ratio), _cubic(ratio)
    finer_first = np.tri(size.size, k=-1)  # pairs (h coarser, l finer)
    fill = (1.0 - ratio) ** 3.3 + 2.8 * ratio * (1.0 - ratio) ** 2.7
    crowd = (1.0 - ratio) ** 2 + 0.4 * ratio * (1.0 - ratio) ** 3.7
    largest = 0.0
    for i in range(size.size):
        inside = (size / size[i] > WINDOW) & (size / size[i] < 1.0 / WINDOW)
        coarser, finer = ~inside & (size > size[i]), ~inside & (size < size[i])
        y = np.where(inside, share, 0.0)
        total = float(y.sum())
        alone = float((y * volume).sum()) / total
        rho = 1.0 / alone
        pairs = np.outer(y, y) * finer_first
        second = 10.0 ** (-1.4566 * rho) * float((quadratic * pairs).sum()) / total**2
        fourth = -1.3092 + 15.039 * rho - 37.453 * rho**2 + 40.869 * rho**3 - 17.110 * rho**4
        third = fourth * float((cubic * pairs * (y[:, None] - y[None, :])).sum()) / total**3
        mixed = alone + second + third
        by_coarser = float((share[coarser] * (mixed - (mixed - 1.0) * crowd[i, coarser])).sum())
        by_finer = float((share[finer] * mixed * (1.0 - fill[i, finer])).sum())
        largest = max(largest, mixed * total + by_coarser + by_finer)
    return 1.0 / largest
