"""The policy that a training leads to, in the form that cells run."""

from learning.environments.config import OBSERVATION_BOUND, DualPegConfig
from learning.networks import Actor
from learning.policy.inputs import Input, Output
from learning.policy.policy import Layer, Policy
from learning.training.plan import Plan


def policy_of(actor: Actor, plan: Plan) -> Policy:
    """Return the actor with the processing that it was trained with."""
    config: DualPegConfig = plan.environment
    x, y, z = config.force_limit_N
    inputs = (
        Input("force_x", x),
        Input("force_y", y),
        Input("force_z", z),
        Input("depth", config.stroke_m),
    )
    names = ("step_x", "step_y", "step_z")
    lengths = plan.settings.residual.range_m
    weights = [weight.detach().numpy() for weight in actor.weights]
    return Policy(
        inputs=inputs,
        outputs=tuple(Output(name, length) for name, length in zip(names, lengths, strict=True)),
        bound=OBSERVATION_BOUND,
        layers=tuple(Layer(*pair) for pair in zip(weights[0::2], weights[1::2], strict=True)),
        expert=plan.expert,
    )
