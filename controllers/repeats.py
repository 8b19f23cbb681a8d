"""Notices a force sensor that repeats itself: as a whole, or on one axis while the others live."""

import math

from drivers.contract.messages import Wrench

_ALL_AXES = (0, 1, 2, 3, 4, 5)
_NOTHING = (math.nan,) * 6
_EQUAL_SAMPLES = 3
"""So many equal samples in a row are no chance, as noise would have to repeat on six axes."""
_EQUAL_READINGS = 50
"""So many equal readings of one axis are no chance if its noise is at least half its resolution."""


class Repeats:
    """Counts over samples in their order.

    An axis is compared with the first sample of a block of 50, so a reading that stays is noticed
    after 50 to 100 samples, and a sensor that works costs next to nothing.
    """

    def __init__(self) -> None:
        self._last: Wrench = _NOTHING
        self._equal = 0
        self._first = _NOTHING
        self._unchanged: tuple[int, ...] = ()
        self._length = _EQUAL_READINGS

    @property
    def is_stuck(self) -> bool:
        """Whether the newest sample is one of too many equal ones."""
        is_frozen = self._length >= _EQUAL_READINGS and bool(self._unchanged)
        return is_frozen or self._equal >= _EQUAL_SAMPLES

    def add(self, wrench: Wrench) -> None:
        """Take note of the next raw sample."""
        self._equal = self._equal + 1 if wrench == self._last else 1
        self._last = wrench
        self._length += 1
        if self._unchanged:
            first = self._first
            self._unchanged = tuple(a for a in self._unchanged if wrench[a] == first[a])
        if self._length > _EQUAL_READINGS and not self._unchanged:
            self._first, self._unchanged, self._length = wrench, _ALL_AXES, 1
