"""Lines are thinned for drawing without losing a peak."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hil.figures.style import thinned

VALUES = st.floats(-1e6, 1e6) | st.just(float("nan"))


@given(y=arrays(np.float64, st.integers(0, 300), elements=VALUES), bins=st.integers(1, 40))
def test_thinning_keeps_the_peaks_and_bounds_the_length(y: np.ndarray, bins: int) -> None:
    x = np.linspace(0.0, 1.0, y.size)
    thin_x, thin_y = thinned(x, y, bins)
    finite = y[np.isfinite(y)]
    assert thin_x.shape == thin_y.shape
    assert thin_y.size <= max(2 * bins, 0)
    assert np.all(np.diff(thin_x) >= 0.0)
    if finite.size:
        assert thin_y.max() == finite.max()
        assert thin_y.min() == finite.min()


def test_a_peak_stays_near_its_place() -> None:
    x = np.linspace(0.0, 10.0, 10_001)
    y = np.where(np.arange(10_001) == 2_500, 5.0, 0.0)
    thin_x, thin_y = thinned(x, y, 100)
    assert abs(thin_x[np.argmax(thin_y)] - 2.5) <= 0.05
