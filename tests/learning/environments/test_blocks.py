"""Batches worked in blocks."""

import numpy as np
import pytest

from learning.environments.blocks import BLOCK, in_blocks


@pytest.mark.parametrize("rows", [1, BLOCK, BLOCK + 1, 5 * BLOCK - 1])
def test_each_row_is_worked_once(rows: int) -> None:
    times = np.zeros(rows, dtype=int)

    def work(block: slice) -> None:
        times[block] += 1

    in_blocks(work, rows)
    assert (times == 1).all()


def test_an_exception_comes_back() -> None:
    def work(block: slice) -> None:
        if block.start > 0:
            raise ValueError("a block failed")

    with pytest.raises(ValueError, match="a block failed"):
        in_blocks(work, 3 * BLOCK)
