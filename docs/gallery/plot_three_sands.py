r"""
Void ratios of three sands in compression
=========================================

Three uniform silica sands in one-dimensional compression to 90 MPa inside an X-ray scanner (E. Ganju, Purdue
University). Their gradings after loading were not published, their void ratios were. ``fit_compression`` looks for
the fabric width :math:`n` and the first crush stress of each (:math:`w = 3`) so that the compressible packing model,
calibrated to the void ratio at the start, meets those at 10, 30 and 90 MPa. The start is assumed: log-normal about
the published median, with a standard deviation of 0.2 in :math:`\ln d`.

What two free numbers for three points prove is little. They show that crushing alone, by grains of a plausible
strength, can take the void ratio down as far and as fast as it went, and so that nothing speaks against the model
here. They do not show that it is right: the sands also rearrange before the first grain breaks, which this model of a
mixed packing cannot know (its curves are flat up to there, the measured ones are not), the start's grading is a
guess, and the intervals, in which each number may lie at a standard deviation of 0.03 in :math:`e`, span a factor of
three and more in :math:`n`, or have no end. That deviation is assumed, as the packing model's own error: estimated
from the misfit of three points by two numbers, with one degree of freedom, it would leave no interval with an end.
Gradings measured after loading tell both numbers; void ratios hardly.
"""

import csv
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

import comminute as cm
from comminute.plotting import PRINT_STYLE, figure_size

folder = next(path for path in (Path.cwd(), *Path.cwd().parents) if (path / "examples" / "compression").is_dir())
with (folder / "examples" / "compression" / "three_sands.csv").open() as file:
    rows = list(csv.DictReader(line for line in file if not line.startswith("#")))

fits, measured = {}, {}
for name in ("2QR", "OGF", "OTC"):
    own = [row for row in rows if row["sand"] == name]
    points = {float(row["stress_MPa"]): float(row["void_ratio"]) for row in own}
    median = float(own[0]["D50_mm"])
    start = cm.lognormal(median, 0.2).with_unit("mm")
    fitted = [stress for stress in points if stress in (10.0, 30.0, 90.0)]
    fits[name] = cm.fit_compression(
        fitted, [points[stress] for stress in fitted], start, cm.Material(reference_size=median), initial=points[0.0]
    )
    measured[name] = points
    print(f"{name}, D50 {median} mm\n{fits[name].table()}\n")


def draw(width: float) -> Figure:
    """Draw the figure `width` mm wide."""
    plt.rcParams.update(PRINT_STYLE)
    narrow = width < 120.0
    figure = plt.figure(figsize=figure_size(width, 130.0 if narrow else 75.0), layout="constrained")
    left, right = figure.subplots(2, 1) if narrow else figure.subplots(1, 2)
    for k, (name, fit) in enumerate(fits.items()):
        colour = f"C{k}"
        left.semilogx(fit.curve_stress, fit.curve, color=colour, label=f"{name}, rms {fit.rms:.3f}")
        stresses = [stress for stress in measured[name] if stress > 0.0]
        left.plot(stresses, [measured[name][stress] for stress in stresses], "o", mfc="none", color=colour)
        for row, parameter in enumerate(("fabric_width", "first_crush_stress")):
            value, (low, high) = fit.values[parameter], fit.intervals[parameter]
            place = row + 0.2 * (1 - k)
            right.plot([low, high], [place] * 2, color=colour)
            right.plot(value, place, "o", color=colour)
    left.set(xlabel="vertical stress (MPa)", ylabel="void ratio", xlim=(0.8, 110.0))
    left.legend()
    right.set(xscale="log", ylim=(-0.6, 1.6), xlabel="value, with its interval of 95 %")
    right.set_yticks([0, 1], ["fabric width", "first crush\nstress (MPa)"])
    for ax in (left, right):
        ax.grid(alpha=0.3, lw=0.4)
    return figure


draw(170.0)
plt.show()
