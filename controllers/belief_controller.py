"""Inserts by what it believes about pose and part: estimate, turn upright, centre, look ahead."""

from collections.abc import Iterator

import numpy as np

from controllers.contact_pose import Belief, ContactModel, ContactPoseFilter
from controllers.contact_pose.look_ahead import LookAheadSettings, look_ahead
from controllers.insertion import Controller
from controllers.messages import ContactBelief, Move, Observation


class BeliefController(Controller):
    """A `Controller` over the contact-pose filter; for one insertion."""

    def __init__(
        self,
        pose_filter: ContactPoseFilter,
        model: ContactModel,
        settings: LookAheadSettings,
        generator: np.random.Generator,
    ) -> None:
        self._filter = pose_filter
        self._model = model
        self._settings = settings
        self._generator = generator
        self._belief = pose_filter.belief()
        self._move: Move | None = None

    @property
    def belief(self) -> Belief:
        """After the newest observation that was thought over."""
        return self._belief

    def think(self, observation: Observation) -> Iterator[None]:
        """Take the observation into the belief and look ahead, in pieces."""
        yield from self._filter.update(observation)
        self._belief = self._filter.belief()
        yield
        self._move = self._look_ahead()
        yield

    def believed(self, observation: Observation) -> ContactBelief:
        """What is believed now, for the log."""
        belief = self._belief
        return ContactBelief(
            stamp_ns=observation.stamp_ns,
            mean=tuple(belief.mean.tolist()),
            covariance=tuple(belief.covariance.ravel().tolist()),
            state=belief.state.name.lower(),
            state_probability=belief.state_probability,
            misfit=belief.misfit,
            restarts=self._filter.restarts,
        )

    def step(self, observation: Observation) -> Move:
        """Return the move that thinking led to: nothing is left to do between watch and proposal.

        Raises `ValueError` before anything has been thought over.
        """
        if self._move is None:
            raise ValueError("step was called before think")
        return self._move

    def _look_ahead(self) -> Move | None:
        population, pose = self._filter.population, self._filter.pose
        if pose is None:
            return None
        return look_ahead(
            self._model,
            population.resampled(self._settings.samples, self._generator),
            population.weights @ population.hypotheses,
            pose,
            self._model.pivot_depth_m,
            self._settings,
        )
