"""The insertion environments' common core: n independent ones, stepped at once."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from learning.environments import kernels
from learning.environments.blocks import in_blocks
from learning.environments.config import ACTION, OBSERVATION, DualPegConfig, Float32Array, Rules
from learning.environments.contact import write_contacts
from learning.environments.kernels import CodeArray, IntArray, Outcome
from simulator.checks import FloatArray
from simulator.engine.batch import Batch as Contacts
from simulator.engine.table import tabulate
from simulator.geometry import POSE_SIZE, checked_poses

_RUNNING, _OUT_OF_STEPS = int(Outcome.RUNNING), int(Outcome.OUT_OF_STEPS)
"""numpy compares with a number of Python's own much faster than with a member."""


@dataclass(frozen=True, slots=True)
class Batch:
    """What n environments are after a step or a reset; rows are environments.

    What the next step starts from is read-only, and no array is ever written again.
    """

    pose: FloatArray
    """(n, 5): pose of the shaft in M, as in `simulator.geometry`."""
    travel_m: FloatArray
    """(n, 3): translation just made."""
    contacts: Contacts
    """Wrench on the part and contact state."""
    steps: IntArray
    """(n,): steps in the episode."""
    episode: IntArray
    """(n,): number of the episode since the key was set."""
    outcome: CodeArray
    """(n,): codes of `Outcome`."""
    terms: FloatArray
    """(n, 4): penalties of f_x and f_y, R_p, R_n."""
    reward: FloatArray
    """(n,)."""
    observation: Float32Array
    """(n, 4): see `OBSERVATION`."""

    @classmethod
    def empty(cls, n: int) -> "Batch":
        """A batch to be filled."""
        return cls(
            pose=np.empty((n, POSE_SIZE)),
            travel_m=np.empty((n, 3)),
            contacts=Contacts.empty(n),
            steps=np.empty(n, dtype=np.int64),
            episode=np.empty(n, dtype=np.int64),
            outcome=np.empty(n, dtype=np.int8),
            terms=np.empty((n, 4)),
            reward=np.empty(n),
            observation=np.empty((n, len(OBSERVATION)), dtype=np.float32),
        )

    @property
    def force_N(self) -> FloatArray:
        """(n, 3): force on the part."""
        return self.contacts.wrench[:, :3]

    @property
    def terminated(self) -> npt.NDArray[np.bool_]:
        """(n,): where the episode ended by what happened in it."""
        return np.asarray((self.outcome != _RUNNING) & (self.outcome != _OUT_OF_STEPS))

    @property
    def truncated(self) -> npt.NDArray[np.bool_]:
        """(n,): where the steps ran out."""
        return np.asarray(self.outcome == _OUT_OF_STEPS)

    def lock(self) -> None:
        """Lock what the next step starts from against writing."""
        kept = (self.pose, self.travel_m, self.contacts.wrench, self.contacts.state, self.terms)
        for array in (*kept, self.steps, self.episode, self.outcome):
            array.setflags(write=False)


class DualPegCore:
    """n environments with the random streams `first_stream` to `first_stream + n - 1` of one key.

    Environment i depends on the key, its stream and its actions alone.
    """

    def __init__(self, config: DualPegConfig, n: int, first_stream: int = 0) -> None:
        if n < 1:
            raise ValueError(f"the number of environments is {n}; it must be at least 1")
        if first_stream < 0:
            raise ValueError(f"stream is {first_stream}; it must be at least 0")
        self.config = config
        self.n = n
        self._rules = Rules.of(config)
        self._table = tabulate([(config.part, config.shaft)])
        self._first_stream = first_stream
        self._key = np.uint64(0)
        self.batch: Batch | None = None
        """The latest; None before the first reset."""

    def reset(self, key: np.uint64 | None, poses: npt.ArrayLike | None = None) -> Batch:
        """Start a new episode everywhere: the first one of `key`, or the next one if it is None.

        `poses` (n, 5) are start poses instead of random ones. Raises `ValueError` for poses that
        are not finite or have another shape, and without a key at the first reset.
        """
        batch = Batch.empty(self.n)
        given = None if poses is None else checked_poses(poses)
        if given is not None and given.shape != batch.pose.shape:
            raise ValueError(f"poses have shape {given.shape}; it must be {batch.pose.shape}")
        if key is not None:
            self._key = key
            batch.episode[:] = 0
        elif self.batch is not None:
            batch.episode[:] = self.batch.episode + 1
        else:
            raise ValueError("key is None; the first reset needs one")
        batch.travel_m[:] = 0.0
        batch.steps[:] = 0
        if given is None:
            kernels.start(self._rules, self._key, self._first_stream, batch.episode, batch.pose)
        else:
            batch.pose[:] = given
        no_action = np.zeros((self.n, len(ACTION)), dtype=np.float32)
        in_blocks(lambda rows: self._conclude(no_action, None, batch, rows), self.n)
        return self._keep(batch)

    def step(self, action: Float32Array) -> Batch:
        """Step all by `action` (n, 3); where the episode is over, start the next one instead.

        Raises `ValueError` before the first reset.
        """
        old = self.batch
        if old is None:
            raise ValueError("step was called before the first reset")
        batch = Batch.empty(self.n)

        def work(rows: slice) -> None:
            kernels.move(
                self._rules,
                self._key,
                self._first_stream + rows.start,
                action[rows],
                old.pose[rows],
                old.outcome[rows],
                old.steps[rows],
                old.episode[rows],
                batch.pose[rows],
                batch.travel_m[rows],
                batch.steps[rows],
                batch.episode[rows],
            )
            self._conclude(action, old, batch, rows)

        in_blocks(work, self.n)
        return self._keep(batch)

    def _conclude(self, action: Float32Array, old: Batch | None, batch: Batch, rows: slice) -> None:
        """Fill in a block of rows from pose and travel on."""
        write_contacts(
            self._table, self.config.law, batch.pose, batch.travel_m, batch.contacts, rows
        )
        kernels.judge(
            self._rules,
            self._key,
            self._first_stream + rows.start,
            action[rows],
            batch.terms[rows] if old is None else old.terms[rows],
            batch.pose[rows],
            batch.contacts.wrench[rows],
            batch.steps[rows],
            batch.episode[rows],
            batch.terms[rows],
            batch.reward[rows],
            batch.outcome[rows],
            batch.observation[rows],
        )

    def _keep(self, batch: Batch) -> Batch:
        batch.lock()
        self.batch = batch
        return batch
