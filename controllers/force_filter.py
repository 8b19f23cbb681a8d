"""The force stream: a Kalman filter over force and its rate, with bias, outlier gate and health.

Each of the six axes is an independent pair (load, its rate) driven by white acceleration noise;
the step is the real time between samples. filterpy computes covariance and gain. Once these have
settled (constant step, nothing rejected) they are kept, and only the mean is carried on, axis by
axis: the same estimate at a tenth of the cost.
"""

import math
from collections.abc import Sequence
from typing import cast

import numpy as np
from filterpy.common import Q_discrete_white_noise
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray
from scipy.stats import chi2

from controllers.messages import FilterHealth, ForceEstimate
from controllers.repeats import Repeats
from controllers.settings import FilterSettings
from controllers.settled_filter import SettledFilter
from drivers.contract.errors import TareRefusedError
from drivers.contract.messages import ForceSample, SensorStatus, Wrench

_AXES = 6
_SETTLED = 1e-6
"""Relative change of the variances, from one sample to the next, below which they are kept."""
_UNKNOWN_RATE_STD = 10.0
"""Rate uncertainty after a jump: so many noise deviations per sample period."""
_ZERO: Wrench = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class ForceFilter:
    """Filters raw samples; `noise_std` is the sensor's, per sample [N, N*m]."""

    def __init__(self, settings: FilterSettings, noise_std: Wrench, period_s: float) -> None:
        self._settings = settings
        self._noise_std = np.array(noise_std)
        self._period_s = period_s
        self._acceleration_std = np.repeat(
            [settings.force_acceleration_std_N_s2, settings.torque_acceleration_std_Nm_s2], 3
        )
        self._nis_limit = float(chi2.ppf(settings.gate_probability, _AXES))
        self._bias: Wrench | None = None
        self._bias_array = np.zeros(_AXES)
        self._kalman = KalmanFilter(dim_x=2 * _AXES, dim_z=_AXES)
        self._kalman.H = np.eye(_AXES, 2 * _AXES)
        self._kalman.R = np.diag(self._noise_std**2)
        self._dt_ns = 0
        self._prior = self._kalman.P
        self._std = _ZERO
        self._settled: SettledFilter | None = None
        self._last: ForceSample | None = None
        self._repeats = Repeats()
        self._rejections = 0
        self._nis = 0.0
        self._restart(np.zeros(_AXES))

    @property
    def bias(self) -> Wrench:
        """What is taken off every raw sample; zero until the first tare."""
        return _ZERO if self._bias is None else self._bias

    def update(self, sample: ForceSample) -> ForceEstimate:
        """Take in one raw sample and return the estimate at its time."""
        last, self._last = self._last, sample
        wrench, stamp_ns = sample.wrench, sample.stamp_ns
        self._repeats.add(wrench)
        if not math.isfinite(sum(wrench)):
            self._nis = math.inf
            return self._estimate(stamp_ns, FilterHealth.REJECTED)
        if last is None or stamp_ns <= last.stamp_ns:
            self._restart(np.array(wrench) - self._bias_array)
            return self._estimate(stamp_ns, FilterHealth.OK)
        if not self._fits(stamp_ns - last.stamp_ns, wrench):
            if self._rejections < self._settings.rejections_max:
                self._rejections += 1
                return self._estimate(stamp_ns, FilterHealth.REJECTED)
            self._restart(np.array(wrench) - self._bias_array)
        self._rejections = 0
        return self._estimate(stamp_ns, FilterHealth.OK)

    def silence(self, now_ns: int) -> ForceEstimate | None:
        """Return the last estimate marked as silent, None if there has never been a sample."""
        return None if self._last is None else self._estimate(now_ns, FilterHealth.SILENT)

    def tare(self, window: Sequence[ForceSample], is_clear: bool) -> Wrench:
        """Take the mean of `window`, raw samples of the unloaded sensor, as the new bias.

        `is_clear` says whether the shaft is out of the part's reach. Weight is part of the bias, so
        a tare holds for one orientation of the arm. Raises TareRefusedError if the sensor may be
        loaded or its samples cannot be trusted; the old bias then stays.
        """
        if not is_clear:
            raise TareRefusedError("the shaft is within reach of the part; move it clear first")
        if len(window) < self._settings.tare_samples:
            raise TareRefusedError(
                f"{len(window)} samples, valid: at least {self._settings.tare_samples}"
            )
        if any(s.status is not SensorStatus.OK for s in window):
            raise TareRefusedError("the sensor reported a fault or saturation")
        loads = np.array([s.wrench for s in window])
        if not np.isfinite(loads).all():
            raise TareRefusedError("a sample is not finite")
        spread = loads.std(axis=0)
        if (spread > 3.0 * self._noise_std).any():
            raise TareRefusedError(f"the load is not steady: {_in_mN(spread)} of deviation")
        half = len(window) // 2
        drift = np.abs(loads[half:].mean(axis=0) - loads[:half].mean(axis=0))
        if (drift > 10.0 * self._noise_std / math.sqrt(half)).any():
            raise TareRefusedError(f"the load drifts by {_in_mN(drift)}")
        bias = loads.mean(axis=0)
        if self._bias is not None:
            change = np.abs(bias - self._bias_array)
            if (change[:3] > self._settings.bias_change_max_N).any():
                raise TareRefusedError(
                    f"the bias would change by {_in_mN(change)}, at most "
                    f"{self._settings.bias_change_max_N * 1e3:.1f} mN: is the sensor in contact?"
                )
        self._bias, self._bias_array = _as_wrench(bias), bias
        self._restart(loads[-1] - bias)
        return self._bias

    def _fits(self, dt_ns: int, wrench: Wrench) -> bool:
        """Predict, and correct by a reading unless it is an outlier."""
        settled = self._settled
        if settled is None or settled.dt_ns != dt_ns:
            self._unsettle()
            return self._fits_unsettled(dt_ns, np.array(wrench) - self._bias_array)
        self._nis = settled.update(wrench, self.bias)
        if self._nis > self._nis_limit:
            self._unsettle()
            self._skip_correction()
            return False
        return True

    def _fits_unsettled(self, dt_ns: int, load: NDArray[np.float64]) -> bool:
        kalman = self._kalman
        if dt_ns != self._dt_ns:
            self._dt_ns = dt_ns
            dt_s = dt_ns * 1e-9
            eye = np.eye(_AXES)
            kalman.F = np.block([[eye, dt_s * eye], [0.0 * eye, eye]])
            unit = Q_discrete_white_noise(dim=2, dt=dt_s, var=1.0)
            kalman.Q = np.kron(unit, np.diag(self._acceleration_std**2))
        before = np.diag(self._prior)
        kalman.predict()
        self._prior = kalman.P
        variance = np.diag(self._prior)
        innovation_variance = variance[:_AXES] + self._noise_std**2
        innovation = load - kalman.x[:_AXES]
        self._nis = float(innovation @ (innovation / innovation_variance))
        if self._nis > self._nis_limit:
            self._skip_correction()
            return False
        kalman.update(load)
        self._std = self._posterior_std()
        if (np.abs(variance - before) <= _SETTLED * variance).all():
            self._settled = SettledFilter(
                dt_ns,
                load_gain=_as_wrench(np.diag(kalman.K[:_AXES])),
                rate_gain=_as_wrench(np.diag(kalman.K[_AXES:])),
                precision=_as_wrench(1.0 / innovation_variance),
                nis_limit=self._nis_limit,
                load=_as_wrench(kalman.x[:_AXES]),
                rate=_as_wrench(kalman.x[_AXES:]),
            )
        return True

    def _skip_correction(self) -> None:
        """Keep the prediction, with its larger uncertainty, in place of a correction."""
        self._kalman.P = self._prior
        self._std = self._posterior_std()

    def _unsettle(self) -> None:
        """Hand the mean back to the full filter."""
        if self._settled is not None:
            self._kalman.x = np.concatenate([self._settled.load, self._settled.rate])
            self._settled = None

    def _restart(self, load: NDArray[np.float64]) -> None:
        rate_std = _UNKNOWN_RATE_STD * self._noise_std / self._period_s
        self._settled = None
        self._kalman.x = np.concatenate([load, np.zeros(_AXES)])
        self._kalman.P = np.diag(np.concatenate([self._noise_std**2, rate_std**2]))
        self._prior = self._kalman.P
        self._std = self._posterior_std()

    def _posterior_std(self) -> Wrench:
        return _as_wrench(np.sqrt(np.diag(self._kalman.P)[:_AXES]))

    def _estimate(self, stamp_ns: int, health: FilterHealth) -> ForceEstimate:
        if self._repeats.is_stuck:
            health |= FilterHealth.STUCK
        if self._bias is None:
            health |= FilterHealth.UNTARED
        settled = self._settled
        if settled is None:
            load, rate = _as_wrench(self._kalman.x[:_AXES]), _as_wrench(self._kalman.x[_AXES:])
        else:
            load, rate = cast(Wrench, settled.load), cast(Wrench, settled.rate)
        return ForceEstimate(stamp_ns, load, rate, self._std, self._nis, health)


def _as_wrench(values: NDArray[np.float64]) -> Wrench:
    fx, fy, fz, tx, ty, tz = values.tolist()
    return (fx, fy, fz, tx, ty, tz)


def _in_mN(loads: NDArray[np.float64]) -> str:
    return ", ".join(f"{v * 1e3:.1f}" for v in loads[:3]) + " mN along x, y, z"
