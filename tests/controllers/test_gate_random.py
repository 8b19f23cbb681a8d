"""The gate under random histories: no command leaves it outside the limits.

It takes no part in the mutation testing: what kills a mutant there kills it in every run.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.messages import Proposal, Snapshot
from drivers.contract.errors import SafetyError
from drivers.contract.messages import Pose, StageState, Vector3
from tests.controllers.builders import (
    MS,
    NOW,
    Bench,
    proposal,
    stage,
)
from tests.controllers.gate_commands import (
    commands,
    let_go,
    pick,
    send_away,
)

Send = Callable[[Bench, Snapshot], None]

anything = st.floats() | st.sampled_from([0.0, 20e-6, -20e-6, 60e-6, 1.0, math.nan, math.inf])
vectors = st.tuples(anything, anything, anything)
plausible = st.floats(-0.3, 0.3)
places = st.tuples(
    st.floats(-250e-6, 250e-6), st.floats(-250e-6, 250e-6), st.floats(-1.1e-3, 3.7e-3)
)
turns = st.tuples(*[st.floats(-0.02, 0.02)] * 3)


poses = st.builds(Pose, places, turns)
stage_states = st.builds(
    stage,
    pose=poses,
    velocity=st.just((0.0, 0.0, 0.0)) | st.tuples(*[st.floats(-0.01, 0.01)] * 3),
    moving=st.booleans(),
)


wishes = st.builds(
    proposal,
    vectors | st.tuples(*[st.floats(-1e-4, 1e-4)] * 3),
    rotation=st.just((0.0, 0.0, 0.0)) | vectors,
)


@settings(max_examples=300)
@given(
    st.sampled_from([stage(-300e-6), stage(-110e-6), stage()]),
    st.lists(
        st.tuples(
            st.integers(-2, 30).map(lambda ms: ms * MS),
            st.just((0.0, 0.0, 0.0)) | st.tuples(plausible, plausible, plausible) | vectors,
            st.none() | stage_states,
            st.just(0) | st.integers(-1, 60).map(lambda ms: ms * MS),
            st.lists(wishes | st.sampled_from([send_away, pick, let_go]), min_size=1, max_size=3),
        ),
        min_size=1,
        max_size=8,
    ),
)
def test_no_command_ever_leaves_the_gate_outside_the_limits(
    calm: StageState,
    events: list[tuple[int, Vector3, StageState | None, int, list[Proposal | Send]]],
) -> None:
    """Whatever is proposed, measured or delayed: 5 mm/s, 1 deg/s, the step box, the workspace.

    However many are tried, one snapshot carries one command, and none after a stop.
    """
    bench = Bench()
    now = NOW
    stopped = False
    for gap, force, other, age, tries in events:
        now += gap
        state = other or calm
        bench.stage.now = state
        seen = bench.see(now, force)
        before, moves_before = len(commands(bench)), len(bench.stage.moves)
        limits = (0.070, 0.100, 1.000)
        too_hard = any(not abs(f) <= n for f, n in zip(force, limits, strict=True))
        for wish in tries:
            stopped = stopped or bool(bench.gate.latched)
            count = len(commands(bench))
            with suppress(SafetyError):
                if isinstance(wish, Proposal):
                    aged = replace(wish, stamp_ns=now - age)
                    bench.gate.send_step(aged, seen, now)
                else:
                    wish(bench, seen)
            if stopped or state.moving or too_hard:
                assert len(commands(bench)) == count
        assert len(commands(bench)) - before <= 1
        for target, speed, angular_speed in bench.stage.moves[moves_before:]:
            assert 0.0 <= speed <= 0.005
            assert 0.0 <= angular_speed <= math.radians(1.0)
            start = state.pose
            for axis, box in enumerate((20e-6, 20e-6, 60e-6)):
                assert abs(target.position[axis] - start.position[axis]) <= box + 1e-15
            for axis, (low, high) in enumerate(
                ((-200e-6, 200e-6), (-200e-6, 200e-6), (-1e-3, 3.6e-3))
            ):
                assert low - 1e-15 <= target.position[axis] <= high + 1e-15
            assert math.hypot(*target.rotation) <= math.radians(0.6) + 1e-12
            for turn, turned in zip(start.rotation, target.rotation, strict=True):
                assert abs(turned - turn) <= math.radians(0.05) + 1e-12
    for speed, angular_speed in bench.stage.slowed:
        assert 0.0 <= speed <= 0.005
        assert 0.0 <= angular_speed <= math.radians(1.0)
