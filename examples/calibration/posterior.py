"""Posterior of a fit by emcee: posterior.py OUT leaves OUT/posterior.png. Needs the extra bayes.

The likelihood is that of the fit, with flat priors on the logarithms of the parameters inside their bounds.
"""

import sys
from pathlib import Path

import emcee
import matplotlib
import numpy as np

import comminute as cm

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = Path(__file__).parent
STRESSES = (5, 10, 20, 40, 80)  # MPa


def main(out: Path, walkers: int = 12, steps: int = 300) -> None:
    """Sample from the best parameters on, print quantiles beside the intervals of the fit, and draw the samples."""
    data = [(float(stress), cm.Grading.read(HERE / f"sand-{stress}MPa.csv")) for stress in STRESSES]
    start, known = cm.Grading.read(HERE / "sand.csv"), cm.Material(reference_size=2.0, weibull_modulus=4.0)
    # One standard deviation for sieving and for what the paper's closure leaves out.
    found = cm.fit(data, start, known, free=["fabric_width", "first_crush_stress"], error=0.03)
    names = found.problem.names

    def log_posterior(logs: np.ndarray) -> float:
        return found.problem.log_likelihood(dict(zip(names, np.exp(logs), strict=True)))

    rng = np.random.default_rng(0)
    first = found.vector + 0.01 * rng.standard_normal((walkers, found.vector.size))
    sampler = emcee.EnsembleSampler(walkers, found.vector.size, log_posterior)
    sampler.random_state = np.random.RandomState(0).get_state()
    sampler.run_mcmc(first, steps)
    samples = np.exp(sampler.get_chain(discard=steps // 4, flat=True))
    for k, name in enumerate(names):
        low, high = np.percentile(samples[:, k], [2.5, 97.5])
        by_fit = found.intervals[name]
        print(f"{name}: {low:.3g} to {high:.3g} by the posterior, {by_fit[0]:.3g} to {by_fit[1]:.3g} by the fit")
    figure, ax = plt.subplots(figsize=(3.6, 3.2), layout="constrained")
    ax.plot(samples[:, 0], samples[:, 1], ".", markersize=1.5, alpha=0.4)
    ax.plot(*(found.values[name] for name in names), "+", color="C3", markersize=10)
    ax.set(xlabel="fabric width", ylabel="first crush stress [MPa]")
    figure.savefig(out / "posterior.png", dpi=200)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
