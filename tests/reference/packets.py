"""The continuum model by packets: a Monte Carlo of its own definition, without bins.

A packet is a grain among neighbours of one mean size. It crushes under a load as long as it lies in the zone of Eq. 2:
the larger of its two log sizes takes a step R = ln X, and of two equal ones either (the slow kernel, Section 4).
Packets know nothing of each other, so that one after the other gives the law of the model, with the noise of their
number.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def gradings(
    draw: Callable[[np.random.Generator, int], Floats],
    step: Callable[[np.random.Generator, int], Floats],
    loads: list[float],
    *,
    fabric_width: float,
    weibull_modulus: float = 3.0,
    packets: int,
    seed: int = 0,
) -> list[Floats]:
    """Sizes of the packets after each of the rising loads, ascending, for a reference size of 1.

    `draw` gives log sizes of the start and `step` values of R, as many as asked for.
    """
    rng = np.random.default_rng(seed)
    grain = draw(rng, packets)
    neighbour = np.log(0.5 * (np.exp(draw(rng, packets)) + np.exp(draw(rng, packets))))
    k = 6.0 * fabric_width**2 / weibull_modulus
    found = []
    for load in loads:
        tip = -weibull_modulus / 3.0 * np.log(load)
        waiting = np.arange(packets)
        while waiting.size:
            a, b = grain[waiting], neighbour[waiting]
            larger = np.maximum(a, b)
            rounding = 1e-12
            active = (a - b) ** 2 <= k * (larger - tip) + rounding
            waiting, a, b = waiting[active], a[active], b[active]
            apart = a - b
            equal = np.abs(apart) < rounding
            crushes = np.where(equal, rng.random(waiting.size) < 0.5, apart > 0.0)
            steps = step(rng, waiting.size)
            grain[waiting] += np.where(crushes, steps, 0.0)
            neighbour[waiting] += np.where(crushes, 0.0, steps)
        found.append(np.sort(np.exp(grain)))
    return found
