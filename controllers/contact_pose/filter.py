"""The contact-pose filter: a belief over hidden pose and part that every observation sharpens."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from controllers.contact_pose.belief import Belief
from controllers.contact_pose.contact_model import ContactModel, Noise, Trace
from controllers.contact_pose.hypotheses import Prior
from controllers.contact_pose.place import PlaceFilter, StageNoise
from controllers.contact_pose.population import Population, in_pieces, take_in
from controllers.messages import Observation
from simulator.checks import FloatArray, positive
from simulator.states import ContactState

_HYPOTHESIS_SOLVES = 8
"""The geometry of a hypothesis takes as long as so many contacts of it."""
RESTARTS_MAX = 3
"""In an insertion: where these did not help, the plant is not among the hypotheses."""
_RESTART_SIZE = 4
"""A restart searches with so many times the usual number of hypotheses."""


@dataclass(frozen=True, slots=True)
class FilterEffort:
    """How much work the filter does. Raises `ValueError`, naming the setting, for too little."""

    hypotheses: int = 512
    moves: int = 8
    """Random moves of each hypothesis after each resampling; too few make the belief too narrow."""
    misfit_max: float = 40.0
    """Misfit of a reading over which the belief is taken for lost and searched anew."""
    solves: int = 2048
    """Contacts solved between two pauses, less than a millisecond's work; changes no result."""

    def piece(self, observations: int) -> int:
        """How many hypotheses may be held against so many observations between two pauses."""
        return max(1, self.solves // (observations + _HYPOTHESIS_SOLVES))

    def __post_init__(self) -> None:
        for name, least in (("hypotheses", 3), ("moves", 1)):
            if (value := getattr(self, name)) < least:
                raise ValueError(f"FilterEffort.{name} is {value}; it must be at least {least}")
        positive("FilterEffort.misfit_max", self.misfit_max)


class ContactPoseFilter:
    """Weighs hypotheses by what the sensor should have read under each of them.

    Alignment errors, stiffness, clearance and friction do not change during an insertion. So the
    hypotheses answer to all observations so far, not only to the newest one.
    """

    def __init__(
        self,
        model: ContactModel,
        prior: Prior,
        noise: Noise,
        stage: StageNoise,
        generator: np.random.Generator,
        effort: FilterEffort = FilterEffort(),
    ) -> None:
        self._model = model
        self._prior = prior
        self._noise = noise
        self._effort = effort
        self._generator = generator
        n = effort.hypotheses
        self.population = Population(prior.drawn(n, generator), np.zeros(n))
        self.restarts = 0
        self.misfit = 0.0
        """See `Belief.misfit`."""
        self._observed: list[FloatArray] = []
        self._place = PlaceFilter(stage)

    @property
    def pose(self) -> FloatArray | None:
        """Where the stage is taken to be (5,), in M; None before the first observation."""
        return self._place.pose

    def update(self, observation: Observation) -> Iterator[None]:
        """Take in an observation; pauses between pieces of work.

        One that the stage has not moved for says nothing new and is left out. Raises `ValueError`
        for one that holds an entry that is not finite, or one too large to compute with.
        """
        _demand_finite(observation)
        last, pose = self.pose, self._place.update(observation)
        if last is None or np.array_equal(pose, last):
            return
        row = np.concatenate([pose, pose[:3] - last[:3], observation.wrench])
        newest = self._trace([row])
        rest = self._model.fit(self.population.hypotheses, newest, self._noise)[0][:, 0]
        if not np.isfinite(rest).all():
            raise ValueError(
                f"step {observation.step}: pose {observation.pose} or wrench {observation.wrench} "
                "is too large for the contact model"
            )
        self._observed.append(row)
        yield
        yield from self._take_in(self.population, rest)
        self.misfit = self._newest_misfit()
        yield
        if self.misfit > self._effort.misfit_max and self.restarts < RESTARTS_MAX:
            yield from self._restart()
            self.misfit = self._newest_misfit()
            yield

    def belief(self) -> Belief:
        """Moments of the belief, and the contact state that it makes likely."""
        weights, hypotheses = self.population.weights, self.population.hypotheses
        mean = weights @ hypotheses
        centred = hypotheses - mean
        state, probability = ContactState.FREE, 1.0
        if self._observed:
            newest = self._trace(self._observed[-1:])
            found = self._model.contacts(hypotheses, newest.poses, newest.travels)
            shares = np.bincount(found.state, weights=weights, minlength=len(ContactState))
            state, probability = ContactState(int(np.argmax(shares))), float(np.max(shares))
        return Belief(
            mean,
            centred.T @ (weights[:, np.newaxis] * centred),
            state,
            probability,
            self.misfit,
        )

    def _newest_misfit(self) -> float:
        newest = self._trace(self._observed[-1:])
        _, misfit = self._model.fit(self.population.hypotheses, newest, self._noise)
        return float(self.population.weights @ misfit[:, 0])

    def _take_in(self, population: Population, rest: FloatArray) -> Iterator[None]:
        def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
            each, _ = self._model.fit(hypotheses, trace, self._noise)
            return each[:, :-1].sum(axis=1), each[:, -1]

        trace, moves = self._trace(self._observed), self._effort.moves
        piece = self._effort.piece(len(trace))
        yield from take_in(population, rest, evaluate, self._prior, moves, self._generator, piece)

    def _restart(self) -> Iterator[None]:
        """Search all of the prior for hypotheses that explain all observations."""

        def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
            each, _ = self._model.fit(hypotheses, trace, self._noise)
            return np.zeros(len(each)), each.sum(axis=1)

        self.restarts += 1
        trace, effort = self._trace(self._observed), self._effort
        n, piece = _RESTART_SIZE * effort.hypotheses, effort.piece(len(trace))
        wide = Population(self._prior.drawn(n, self._generator), np.zeros(n))
        _, rest = yield from in_pieces(evaluate, wide.hypotheses, piece)
        yield from take_in(wide, rest, evaluate, self._prior, effort.moves, self._generator, piece)
        hypotheses = wide.resampled(effort.hypotheses, self._generator)
        self.population = Population(hypotheses, np.zeros(effort.hypotheses))

    @staticmethod
    def _trace(rows: list[FloatArray]) -> Trace:
        columns = np.array(rows)
        return Trace(columns[:, :5], columns[:, 5:8], np.ascontiguousarray(columns[:, 8:]))


def _demand_finite(observation: Observation) -> None:
    for name, values in (
        ("wrench", observation.wrench),
        ("pose.position", observation.pose.position),
        ("pose.rotation", observation.pose.rotation),
        ("commanded.position", observation.commanded.position),
    ):
        if not np.isfinite(values).all():
            raise ValueError(
                f"step {observation.step}: {name} is {values}; every entry must be finite"
            )
