"""A reader of a picture objects to texts that overlap or leave it, and to axes without a label."""

from itertools import combinations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

SLACK = 1.0  # pixels by which boxes of text may meet, since their corners are empty


def _texts(ax: Axes) -> list[Text]:
    """Texts of one axes that can be read: titles, labels, tick labels in view, and what is written inside."""
    found = [ax.title, *ax.texts]
    for axis, (low, high) in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
        if not axis.get_visible():
            continue
        found.append(axis.label)
        ends = min(low, high), max(low, high)
        for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
            shown = ends[0] <= tick.get_loc() <= ends[1]
            found += [label for label in (tick.label1, tick.label2) if shown and label.get_visible()]
    legend = ax.get_legend()
    if legend is not None:
        found += [legend.get_title(), *legend.get_texts()]
    return [text for text in found if text.get_visible() and text.get_text()]


def _with_insets(axes: list[Axes]) -> list[Axes]:
    return [one for ax in axes for one in (ax, *_with_insets([c for c in ax.child_axes if isinstance(c, Axes)]))]


def objections(figure: Figure) -> list[str]:
    """List pairs of texts that overlap, texts that leave the picture, and axes with ticks but without a label."""
    figure.draw_without_rendering()  # which lays it out
    axes = _with_insets(list(figure.axes))
    boxes = [(text.get_text(), text.get_window_extent()) for ax in axes for text in _texts(ax)]
    found = []
    for (a, box), (b, other) in combinations(boxes, 2):
        shared = Bbox.intersection(box, other)
        if shared is not None and min(shared.width, shared.height) > SLACK:
            found.append(f"{a!r} overlaps {b!r}")
    page = figure.bbox
    for text, box in boxes:
        if box.x0 < page.x0 - SLACK or box.y0 < page.y0 - SLACK or box.x1 > page.x1 + SLACK or box.y1 > page.y1 + SLACK:
            found.append(f"{text!r} leaves the picture")
    for ax in axes:
        for axis in (ax.xaxis, ax.yaxis):
            ticks = [t for t in axis.get_major_ticks() if t.label1.get_visible() and t.label1.get_text()]
            if axis.get_visible() and ticks and not axis.label.get_text():
                found.append(f"an axis of {ax.get_title()!r} has no label")
    return found
