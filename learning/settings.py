"""Settings of a training: the file as a whole, and what its algorithm is set by."""

from collections.abc import Iterator
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen
from pydantic import Field, model_validator

from controllers.settings import ProportionalSettings
from drivers.contract.messages import Vector3
from drivers.contract.settings import MICRO, MILLI, Settings, written

_Length = Annotated[float, Gt(0), Le(1_000)]
_Lengths = Annotated[tuple[_Length, _Length, _Length], MICRO]
_Force = Annotated[float, Gt(0), Le(10_000)]
_Sigma = Annotated[float, Ge(0), Le(1)]


class RewardSettings(Settings):
    """Weights of the reward, eqs. (12) and (13)."""

    alpha_x: Annotated[float, Ge(0), Le(1)]
    """alpha_1, of the force along x."""
    alpha_y: Annotated[float, Ge(0), Le(1)]
    """alpha_2, of the force along y."""
    omega: Annotated[float, Gt(1), Le(100)]
    """A step too short costs this many times less than one as much too long."""

    @model_validator(mode="after")
    def _check(self) -> "RewardSettings":
        if abs(self.alpha_x + self.alpha_y - 1.0) > 1e-9:
            raise ValueError(
                f"alpha_y = {self.alpha_y:.12g} is not valid: must be {1.0 - self.alpha_x:.12g}, "
                "such that alpha_x and alpha_y add up to 1"
            )
        return self


class TaskSettings(Settings):
    """What an insertion in training may do, where it starts and when it fails."""

    step_box_m: _Lengths = Field(alias="step_box_um")
    """Longest step along each axis, to either side."""
    force_limit_N: Annotated[tuple[_Force, _Force, _Force], MILLI] = Field(alias="force_limit_mN")
    """A larger force along an axis is a failure."""
    start_depth_m: Annotated[float, Ge(-1_000), Le(0), MICRO] = Field(alias="start_depth_um")
    """Depth at which an insertion starts."""
    state_sigma: _Sigma
    """sigma_2 of eq. (16): noise on the state, as a share of force limits and stroke."""
    reward: RewardSettings


class ResidualSettings(Settings):
    """What the policy may add to the expert."""

    range_m: _Lengths = Field(alias="range_um")
    """Largest residual along each axis, to either side."""


class ExplorationSettings(Settings):
    """Noise on actions, in units of the residual's range (eqs. 14 and 15)."""

    sigma_first: _Sigma
    """In the first round."""
    sigma_success: _Sigma
    """After a success."""
    sigma_failure: _Sigma
    """After a failure."""


class NetworkSettings(Settings):
    """Size and optimiser of a network."""

    hidden: Annotated[tuple[Annotated[int, Ge(1), Le(4_096)], ...], MinLen(1), MaxLen(8)]
    """Width of each hidden layer."""
    learning_rate: Annotated[float, Gt(0), Le(1)]
    """Adam's."""


class AdditionSettings(Settings):
    """What later algorithms added to DDPG; `docs/reference/ablation.md` says what each is worth."""

    twin_critics: bool
    """Two critics; goals take the smaller of their targets' values (clipped double Q)."""
    critic_norm: Literal["none", "layer", "batch"]
    """What each hidden layer of a critic is normalised by, ahead of its ReLU. With `batch` there
    are no targets: a batch and what followed it pass the critic together (CrossQ)."""
    return_steps: Annotated[int, Ge(1), Le(1_000)]
    """Rewards that a transition sums up before the goal relies on a value (n-step returns)."""
    target_noise: Annotated[float, Ge(0), Le(1)]
    """Standard deviation of the noise on the action that a goal's value is of, in units of the
    residual's range (target policy smoothing)."""
    actor_period: Annotated[int, Ge(1), Le(1_000_000)]
    """Updates from one step of the actor to the next (delayed actor)."""


NO_ADDITIONS = AdditionSettings(
    twin_critics=False, critic_norm="none", return_steps=1, target_noise=0.0, actor_period=1
)


class DdpgSettings(Settings):
    """The algorithm (Algorithm 1 and Table 1)."""

    replay_size: Annotated[int, Ge(1), Le(10_000_000)]
    """M_E: transitions to learn from, the latest."""
    batch_size: Annotated[int, Ge(1), Le(1_000_000)]
    """N: transitions of an update; learning begins when there are as many."""
    discount: Annotated[float, Ge(0), Lt(1)]
    """gamma."""
    target_rate: Annotated[float, Gt(0), Le(1)]
    """tau: share of the way that the targets go to their networks at a time (eq. 9)."""
    target_period: Annotated[int, Ge(1), Le(1_000_000)]
    """T: updates from one move of the targets to the next."""
    terminal_mask: bool
    """Whether nothing is to be gained after the end of an episode; Algorithm 1 has no such mask."""
    actor: NetworkSettings
    critic: NetworkSettings
    actor_last_weight: Annotated[float, Ge(0), Le(1)]
    """Largest magnitude of weights and biases of the actor's last layer at first."""
    additions: AdditionSettings | None = None
    """None for Algorithm 1 as it is."""

    @model_validator(mode="after")
    def _check(self) -> "DdpgSettings":
        if self.batch_size > self.replay_size:
            raise ValueError(
                f"batch_size = {self.batch_size} is not valid: must not exceed "
                f"replay_size = {self.replay_size}, or nothing is ever learned"
            )
        return self


class EvaluationSettings(Settings):
    """How a trained policy is judged: without noise, from states that training has not seen."""

    initial_states: Annotated[int, Ge(1), Le(100_000)]


class TrainingSettings(Settings):
    """All of a training but its seed."""

    part: Annotated[str, MinLen(1), MaxLen(1_000)]
    """File of the part, relative to this one."""
    task: TaskSettings
    expert: ProportionalSettings
    residual: ResidualSettings
    rounds: Annotated[int, Ge(1), Le(1_000_000)]
    """Insertions to learn from."""
    initial_states: Annotated[int, Ge(1), Le(100_000)]
    """Start poses that the rounds draw from."""
    exploration: ExplorationSettings
    ddpg: DdpgSettings
    evaluation: EvaluationSettings
    checkpoint_rounds: Annotated[int, Ge(1), Le(1_000_000)]
    """Rounds from one checkpoint to the next."""

    @model_validator(mode="after")
    def _check(self) -> "TrainingSettings":
        if problems := [*self._problems()]:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        box: Vector3 = self.task.step_box_m
        if any(r > b for r, b in zip(self.residual.range_m, box, strict=True)):
            key = written(ResidualSettings, "range_m", self.residual.range_m)
            valid = written(TaskSettings, "step_box_m", box)
            yield f"residual.{key} is not valid: must not exceed task.{valid}"
