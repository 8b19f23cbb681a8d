"""Where the shaft really is: a Bayesian filter over its pose and the part, by contact.

A contact at a known place of the stage tells of the offset, tilt, stiffness and clearance that no
camera sees. Hypotheses about them are weighed with the contact model as the likelihood. This is the
one place where controllers use the simulator: its geometry and contact, never a world's state.
"""

from controllers.contact_pose.belief import Belief
from controllers.contact_pose.contact_model import ContactModel, Noise
from controllers.contact_pose.filter import ContactPoseFilter, FilterEffort
from controllers.contact_pose.hypotheses import Parameter, Prior
from controllers.contact_pose.look_ahead import LookAheadSettings
from controllers.contact_pose.place import StageNoise

__all__ = [
    "Belief",
    "ContactModel",
    "ContactPoseFilter",
    "FilterEffort",
    "LookAheadSettings",
    "Noise",
    "Parameter",
    "Prior",
    "StageNoise",
]
