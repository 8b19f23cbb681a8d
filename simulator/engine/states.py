"""Contact states as in `simulator.states`, from which stations touch, without branches."""

import numpy as np

from simulator.compiled import inlined
from simulator.states import ContactState

INVALID = -1
"""State of a pose that is not finite or tilted by a quarter turn or more."""

_A, _B, _C, _D, _E = (int(ContactState[name]) for name in "ABCDE")
_F, _G, _H, _I = (int(ContactState[name]) for name in "FGHI")
_ONE, _TWO, _FOUR = np.uint64(1), np.uint64(2), np.uint64(4)
_PAIRS, _QUADS = np.uint64(0x5555555555555555), np.uint64(0x3333333333333333)
_BYTES, _SUM, _TOP = np.uint64(0x0F0F0F0F0F0F0F0F), np.uint64(0x0101010101010101), np.uint64(56)


@inlined
def bit_count(bits: np.uint64) -> int:
    """How many bits are set."""
    bits -= (bits >> _ONE) & _PAIRS
    bits = (bits & _QUADS) + ((bits >> _TWO) & _QUADS)
    bits = (bits + (bits >> _FOUR)) & _BYTES
    return int((bits * _SUM) >> _TOP)


@inlined
def contact_state(
    upper: np.uint64, lower: np.uint64, depth: float, first_exit: float, second_entry: float
) -> tuple[int, int]:
    """State and number of touching stations; bit i of `upper` and `lower` is for wall i.

    `depth` is that of the leading end, `second_entry` NaN for a part with one hole.
    """
    points = bit_count(upper) + bit_count(lower)
    apart = (upper & lower) == np.uint64(0)
    third = _I if points > 2 else ((_H if apart else _G) if points == 2 else _F)
    second = _D if points == 1 else _E
    first = (_B if upper == np.uint64(0) else _A) if points == 1 else _C
    inserting = (depth > second_entry) | ((upper | lower) > _ONE)
    approaching = (depth > first_exit) & (second_entry == second_entry)
    state = third if inserting else (second if approaching else first)
    return (state if points > 0 else 0), points
