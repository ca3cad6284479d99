"""Curves whose arrays run backwards or have gaps in memory."""

import numpy as np

import comminute as cm


def test_a_curve_may_be_a_view_of_any_array() -> None:
    size, finer = np.array([0.1, 1.0, 10.0]), np.array([0.0, 0.4, 1.0])
    plain = cm.SizeCurve(size, finer)
    backwards = cm.SizeCurve(size[::-1].copy()[::-1], finer[::-1].copy()[::-1])
    gaps = cm.SizeCurve(np.repeat(size, 2)[::2], np.repeat(finer, 2)[::2])
    at = np.array([0.05, 0.3, 1.0, 5.0, 20.0])
    for curve in (backwards, gaps):
        assert not curve.size.flags["C_CONTIGUOUS"]
        assert np.array_equal(curve.finer_than(at), plain.finer_than(at))
        assert np.array_equal(curve.finer_than(at[::-1]), plain.finer_than(at)[::-1])
        assert curve.percentile(50) == plain.percentile(50)
        assert cm.breakage_index(plain, curve).index == 0.0
        assert cm.breakage_potential(cm.SizeCurve(curve.size, curve.finer, "mm")) == cm.breakage_potential(
            cm.SizeCurve(size, finer, "mm")
        )
