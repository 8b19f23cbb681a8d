"""Random numbers by their number: Philox4x64-10, compiled.

A counter-based generator (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC11) has
no state: a counter and a key give four words. So each environment has a stream of its own, and its
draws depend on neither the number of environments nor the order in which they are worked.
`numpy.random.Philox` is the same generator; it adds 1 to its counter before it draws.
"""

import math

import numpy as np

from simulator.compiled import scalar

Words = tuple[np.uint64, np.uint64, np.uint64, np.uint64]
Floats = tuple[float, float, float, float]

ROUNDS = 10
_FACTOR_0 = np.uint64(0xD2E7470EE14C6C93)
_FACTOR_1 = np.uint64(0xCA5A826395121157)
_WEYL_0 = np.uint64(0x9E3779B97F4A7C15)
_WEYL_1 = np.uint64(0xBB67AE8584CAA73B)
_HALF = np.uint64(32)
_LOW = np.uint64(0xFFFFFFFF)
_TO_53_BITS = np.uint64(11)
_ULP = 2.0**-53


@scalar
def high_product(a: np.uint64, b: np.uint64) -> np.uint64:
    """Upper 64 bits of the product a*b of 128 bits."""
    a_low, a_high = a & _LOW, a >> _HALF
    b_low, b_high = b & _LOW, b >> _HALF
    middle = a_high * b_low + ((a_low * b_low) >> _HALF)
    lower = (middle & _LOW) + a_low * b_high
    return a_high * b_high + (middle >> _HALF) + (lower >> _HALF)


@scalar
def words(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> Words:
    """Four words for the counter (c0, c1, c2, c3) and the key (k0, k1)."""
    for _ in range(ROUNDS):
        high_0, low_0 = high_product(_FACTOR_0, c0), _FACTOR_0 * c0
        high_1, low_1 = high_product(_FACTOR_1, c2), _FACTOR_1 * c2
        c0, c1, c2, c3 = high_1 ^ c1 ^ k0, low_1, high_0 ^ c3 ^ k1, low_0
        k0 += _WEYL_0
        k1 += _WEYL_1
    return c0, c1, c2, c3


@scalar
def uniforms(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> Floats:
    """Four numbers uniform in [0, 1), each from the upper 53 bits of a word, as numpy has it."""
    w0, w1, w2, w3 = words(c0, c1, c2, c3, k0, k1)
    return (
        (w0 >> _TO_53_BITS) * _ULP,
        (w1 >> _TO_53_BITS) * _ULP,
        (w2 >> _TO_53_BITS) * _ULP,
        (w3 >> _TO_53_BITS) * _ULP,
    )


@scalar
def normals(
    c0: np.uint64, c1: np.uint64, c2: np.uint64, c3: np.uint64, k0: np.uint64, k1: np.uint64
) -> Floats:
    """Four standard normal numbers, two from each pair of uniform ones (Box and Muller)."""
    u0, u1, u2, u3 = uniforms(c0, c1, c2, c3, k0, k1)
    r0, r1 = math.sqrt(-2.0 * math.log(1.0 - u0)), math.sqrt(-2.0 * math.log(1.0 - u2))
    a0, a1 = 2.0 * math.pi * u1, 2.0 * math.pi * u3
    return r0 * math.cos(a0), r0 * math.sin(a0), r1 * math.cos(a1), r1 * math.sin(a1)
