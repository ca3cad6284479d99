"""A callback for GrainLearning, the Bayesian calibration of DEM: grain_learning.py finds two parameters of a sand.

GrainLearning 2.0 wants an older NumPy than other libraries do, and so an environment of its own. Its callback runs the
model for each sample of the parameters, and hands over what sieves would measure.
"""

from pathlib import Path
from typing import Any

import numpy as np

import comminute as cm

HERE = Path(__file__).parent
STRESSES = (5, 10, 20, 40, 80)  # MPa
SIEVES = [1.6, 1.0, 0.5, 0.25, 0.125, 0.063]  # mm
NAMES = ("fabric_width", "first_crush_stress")


def run(calibration: Any) -> None:
    """Run the model for each sample of the parameters: sets one row of mass fractions finer for each."""
    start = cm.Grading.read(HERE / "sand.csv")
    rows = []
    for sample in calibration.system.param_data:
        width, stress = (float(value) for value in sample)
        material = cm.Material(reference_size=2.0, weibull_modulus=4.0, fabric_width=width, first_crush_stress=stress)
        result = cm.Simulation(material, start).run(stress=STRESSES, keep_fabrics=[])
        rows.append(np.concatenate([result.curve(k).finer_than(SIEVES) for k in range(len(STRESSES))]))
    calibration.system.set_sim_data(np.array(rows)[:, None, :])


def main() -> None:
    """Three iterations of thirty samples."""
    from grainlearning import BayesianCalibration  # noqa: PLC0415  (the callback alone does not need it)

    measured = [cm.Grading.read(HERE / f"sand-{stress}MPa.csv").finer(SIEVES) for stress in STRESSES]
    observed = np.concatenate(measured)
    settings: dict[str, Any] = {
        "num_iter": 3,
        "callback": run,
        "system": {
            "param_min": [0.1, 0.5],
            "param_max": [1.0, 4.0],
            "param_names": list(NAMES),
            "num_samples": 30,
            "obs_data": observed[None, :],
            "obs_names": ["finer"],
            "ctrl_data": np.arange(observed.size),
            "sim_name": "comminute",
            "sigma_tol": 0.01,
        },
        "inference": {
            "Bayes_filter": {"ess_target": 0.3},
            "sampling": {"max_num_components": 2, "random_state": 0, "slice_sampling": True},
        },
        "save_fig": -1,
    }
    calibration = BayesianCalibration.from_dict(settings)
    calibration.run()
    best = calibration.get_most_prob_params()
    for name, value in zip(NAMES, best, strict=True):
        print(f"{name}: {value:.3g}")


if __name__ == "__main__":
    main()
