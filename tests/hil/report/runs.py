"""Writes small logs sample by sample: what a test states in people's units is what the log holds.

Samples come every 10 ms, so that the recorder keeps the stage's pose at each of them.
"""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from controllers.messages import (
    ContactBelief,
    FilterHealth,
    ForceEstimate,
    Observation,
    PhaseChange,
    Proposal,
    Reason,
    ResetRecord,
    Sent,
    SkillPhase,
    Snapshot,
    Tick,
    Verdict,
)
from drivers.contract.messages import ForceSample, Pose, StageState, Vector3, Wrench
from hil.log_file import LogFile
from hil.log_reader import Log, read_log
from hil.recorder import Recorder
from hil.ros_messages import ContactTruth

MS = 1_000_000
START_NS = 1_700_000_000_000_000_000
ZERO6 = (0.0,) * 6

PART = """
name: two_walls
holes:
  - diameter_um: 1010
    thickness_um: 500
  - diameter_um: 1010
    thickness_um: 500
    gap_um: 1500
"""
ONE_HOLE = """
name: one_wall
holes:
  - thickness_um: 500
"""


def metadata(
    asked: int = 1, controller: str = "expert", time: str = "simulated", part: str = PART
) -> dict[str, dict[str, str]]:
    """Return a log's metadata: a part with walls at 0 to 0.5 mm and 2.0 to 2.5 mm."""
    return {
        "run": {
            "controller": controller,
            "insertions": str(asked),
            "seed": "7",
            "time": time,
        },
        "limits": {"in_force": json.dumps({"force_N": [0.07, 0.1, 1.0], "speed_m_s": 0.005})},
        "part": {"text": part},
    }


class RunWriter:
    """Drives a recorder as the control loop does."""

    def __init__(
        self,
        path: Path,
        about: Mapping[str, Mapping[str, str]],
        bias_mN: Vector3 = (0.0, 0.0, 0.0),
        busy_ns: int = 0,
    ) -> None:
        self.path = path
        self.now_ns = START_NS
        self._recorder = Recorder(LogFile(path, about))
        self._bias: Wrench = (*(b * 1e-3 for b in bias_mN), 0.0, 0.0, 0.0)  # type: ignore[assignment]
        self._busy_ns = busy_ns
        self._samples = 0
        self._proposals = 0
        self._depth_um = -300.0

    def sample(
        self, force_mN: Vector3, depth_um: float, *reasons: Reason, cap_mm_s: float = float("inf")
    ) -> None:
        """Let 10 ms pass, then a raw sample: this force on top of the bias, at this depth."""
        self.now_ns += 10 * MS
        self._samples += 1
        self._depth_um = depth_um
        x, y, z = (f * 1e-3 + b for f, b in zip(force_mN, self._bias[:3], strict=True))
        sample = ForceSample(self.now_ns, self.now_ns, self._samples, (x, y, z, 0.0, 0.0, 0.0))
        estimate = ForceEstimate(self.now_ns, ZERO6, ZERO6, ZERO6, 1.0, FilterHealth.OK)
        pose = Pose((0.0, 0.0, depth_um * 1e-6))
        snapshot = Snapshot(
            now_ns=self.now_ns,
            sample=sample,
            bias=self._bias,
            estimate=estimate,
            stage=StageState(self.now_ns, pose, (0.0,) * 3, (0.0,) * 3, moving=False),
            arm=None,
            gripper=None,
        )
        verdict = Verdict(self.now_ns, reasons, cap_mm_s * 1e-3)
        self._recorder.on_sample(sample)
        self._recorder.on_tick(Tick(snapshot, verdict, self.now_ns, self.now_ns + self._busy_ns))

    def phase(self, insertion: int, phase: SkillPhase, reason: str = "") -> None:
        """Enter a phase on the newest sample."""
        self._recorder.on_phase(PhaseChange(self.now_ns, insertion, phase, reason, 0))

    def step(self, *reasons: Reason, is_sent: bool = True, speed_mm_s: float = 4.0) -> None:
        """Propose a step on the newest sample, and answer it 1 ms later."""
        self._proposals += 1
        pose = Pose((0.0, 0.0, self._depth_um * 1e-6))
        observation = Observation(self.now_ns, 0, ZERO6, ZERO6, pose, (0.0, 0.0, 0.0), pose)
        proposal = Proposal(self.now_ns, self._proposals, "expert", (1e-6, 0.0, 5e-5))
        self._recorder.on_proposal(observation, proposal)
        self.now_ns += MS
        verdict = Verdict(self.now_ns, reasons, speed_mm_s * 1e-3)
        sent = Sent(
            self.now_ns,
            self._proposals,
            verdict,
            pose if is_sent else None,
            (1e-6, 0.0, 5e-5),
            speed_m_s=speed_mm_s * 1e-3 if is_sent else 0.0,
        )
        self._recorder.on_sent(sent)

    def contact(self, state: str) -> None:
        """State the truth about the contact, as a mock cell does."""
        depth_m = self._depth_um * 1e-6
        shaft = Pose((0.0, 0.0, depth_m))
        self._recorder.on_truth(ContactTruth(self.now_ns, state, "", 1, depth_m, ZERO6, shaft))

    def believe(self, offset_um: float, std_um: float) -> None:
        """Believe in an offset along x on the newest sample, and propose a step."""
        covariance = np.diag([std_um * 1e-6, 1e-6, 1e-3, 1e-3, 1e3, 1e-6, 0.1]) ** 2
        mean = (offset_um * 1e-6, 0.0, 0.0, 0.0, 4e3, 1e-5, 0.2)
        self._recorder.on_belief(
            ContactBelief(self.now_ns, mean, tuple(covariance.ravel().tolist()), "c", 0.9, 6.0, 0)
        )
        self.step()

    def reset(self, operator: str) -> None:
        """Let an operator reset the supervisor 1 ms later."""
        self.now_ns += MS
        self._recorder.on_reset(ResetRecord(self.now_ns, operator, ()))

    def insertion(
        self, number: int, radial_mN: float = 5.0, end: SkillPhase = SkillPhase.DONE
    ) -> None:
        """Make a whole insertion of the part, one step of 500 um per sample."""
        self.sample((0.0, 0.0, 0.0), -300.0)
        self.phase(number, SkillPhase.APPROACH)
        self.step()
        self.sample((0.0, 0.0, 0.0), 0.0)
        self.phase(number, SkillPhase.INSERT)
        for depth_um in (500.0, 1000.0, 1500.0, 2000.0, 2300.0):
            self.contact("c")
            self.step()
            self.sample((radial_mN, 0.0, 1.0), depth_um)
        self.sample((0.0, 0.0, 0.0), 2300.0)
        self.phase(number, end, "" if end is SkillPhase.DONE else "it did not fit")

    def close(self, ending: str = "") -> Log:
        """Finish the log and read it."""
        self._recorder.close(ending)
        return read_log(self.path)
