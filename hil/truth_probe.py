"""Logs what a mock cell knows of the contact at each proposal; a rig has no such thing."""

from controllers.control_loop import Subscriber
from controllers.messages import Observation, Proposal
from drivers.mock_world import MockWorld
from hil.recorder import Recorder
from hil.ros_messages import ContactTruth


class TruthProbe(Subscriber):
    """Takes the truth from the world and hands it to the recorder."""

    def __init__(self, world: MockWorld, recorder: Recorder) -> None:
        self._world = world
        self._recorder = recorder

    def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
        """Record the contact at the time of the observation."""
        truth = self._world.truth(observation.stamp_ns)
        if truth is not None:
            self._recorder.on_truth(
                ContactTruth(
                    truth.stamp_ns,
                    truth.state.name.lower(),
                    truth.phase,
                    truth.contacts,
                    truth.depth_m,
                    truth.wrench,
                    truth.shaft,
                )
            )
