"""The force filter's mean once its gains have settled: constant gains, axis by axis."""

from dataclasses import dataclass

Axes = tuple[float, ...]
"""One value for each axis."""


@dataclass(slots=True)
class SettledFilter:
    """Carries on load and rate in plain floats, which for so few axes beats arrays."""

    dt_ns: int
    """The time step for which the gains hold."""
    load_gain: Axes
    rate_gain: Axes
    """[1/s]"""
    precision: Axes
    """Inverse variance of the innovation."""
    nis_limit: float
    load: Axes
    """[N, N*m]"""
    rate: Axes
    """Time derivative of `load`."""

    def update(self, reading: Axes, bias: Axes) -> float:
        """Predict one time step on; correct by `reading` less `bias` unless it is an outlier.

        Returns the normalised innovation squared, above `nis_limit` for an outlier.
        """
        dt_s = self.dt_ns * 1e-9
        nis = 0.0
        predicted, innovations = [], []
        for value, offset, load, rate, precision in zip(
            reading, bias, self.load, self.rate, self.precision, strict=True
        ):
            expected = load + dt_s * rate
            innovation = value - offset - expected
            nis += innovation * innovation * precision
            predicted.append(expected)
            innovations.append(innovation)
        if nis > self.nis_limit:
            self.load = tuple(predicted)
            return nis
        self.load = tuple(
            [p + g * i for p, g, i in zip(predicted, self.load_gain, innovations, strict=True)]
        )
        self.rate = tuple(
            [r + g * i for r, g, i in zip(self.rate, self.rate_gain, innovations, strict=True)]
        )
        return nis
