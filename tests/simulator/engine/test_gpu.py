"""The GPU's kernel, in numba's simulator of a CUDA device: the same functions, interpreted."""

import os
import subprocess
import sys

import pytest

SCRIPT = """
import numpy as np
from simulator.contact import ContactLaw, solve as reference
from simulator.engine import gpu
from simulator.engine.table import tabulate
from tests.simulator.engine.agreement import compared
from tests.simulator.engine.test_agreement import directions
from tests.simulator.shapes import PARTS, SHAFTS, pressing_poses

for name in ("rounded", "barrel"):
    part, shaft = PARTS["two chamfered"], SHAFTS[name]
    poses, sliding = pressing_poses(part, 60, 1, 6e-3, 1.5e-5), directions(60, 2)
    contacts = reference(part, shaft, poses, sliding, ContactLaw(3e3, 0.3))
    found = gpu.solve(tabulate([(part, shaft)]), poses, sliding, stiffness_N_m=3e3, friction=0.3)
    print(compared(found, contacts, part, shaft, poses))
poses[7, 3] = np.nan
print(np.flatnonzero(gpu.solve(tabulate([(part, shaft)]), poses, sliding).state < 0))
"""


@pytest.mark.slow
def test_threads_of_a_simulated_device_repeat_the_reference() -> None:
    simulated = {
        "NUMBA_ENABLE_CUDASIM": "1",
        "NUMBA_DISABLE_JIT": "1",
        "PYTHONPATH": ".",
    }
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env=os.environ | simulated,
        capture_output=True,
        text=True,
        check=True,
    )
    *worst, invalid = run.stdout.splitlines()
    assert all(float(number) < 1e-9 for number in worst), run.stdout
    assert invalid == "[7]"
