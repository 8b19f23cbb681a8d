"""Actors of stable-baselines3 as our policies, how policies are judged, and the comparison."""

import re
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import torch

from benchmarks.off_the_shelf import library, result
from benchmarks.off_the_shelf.library import ALGORITHMS, AS_REGISTERED, ExpertBeside, Formulation
from benchmarks.off_the_shelf.ours import without_expert
from benchmarks.off_the_shelf.quality import Point, Quality, Recorder, quality_of, start_poses
from benchmarks.off_the_shelf.runs import OURS, Run, Task
from learning.analytic.plan import load_analytic
from learning.environments import PAPER, DualPegEnv, Outcome
from learning.policy.expert import Expert
from learning.policy.file import load_policy
from learning.task import InsertionTask, Start
from tests.learning.policy.policies import EXPERT, zero_policy
from tests.learning.training.plans import short_file, short_plan

pytestmark = pytest.mark.slow
"""Loading and stepping the library takes longer than the short loop should."""

BESIDE = Formulation(PAPER, EXPERT, (2e-6, 3e-6, 30e-6), ends=False)
WHOLE_STEP = Expert(0.0, 0.0, PAPER.step_box_m)


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


@pytest.mark.parametrize("form", [AS_REGISTERED, BESIDE], ids=["direct", "beside an expert"])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_converted_actor_answers_as_the_model_does(algorithm: str, form: Formulation) -> None:
    model = library.make(algorithm, form, seed=1, buffer_size=10)
    with torch.no_grad():
        for weight in model.actor.parameters():
            weight *= 3.0
    generator = np.random.default_rng(1)
    seen = generator.uniform(-2.5, 2.5, (500, 4)).clip(-2.0, 2.0).astype(np.float32)
    wanted, _ = model.predict(seen, deterministic=True)
    policy = library.converted(model, form)
    found = policy.residuals(seen * np.array([0.07, 0.1, 1.0, 2.3e-3])) / np.array(form.range_m)
    assert np.abs(found - wanted).max() < 2e-6
    assert (wanted.std(axis=0) > 0.2).all()
    assert policy.expert == form.expert


def test_the_registered_environment_has_no_expert() -> None:
    assert Formulation(PAPER, WHOLE_STEP, (20e-6, 20e-6, 60e-6), ends=True) == AS_REGISTERED


def test_another_network_is_refused() -> None:
    model = library.make("td3", AS_REGISTERED, seed=1, buffer_size=10)
    model.actor.mu[1] = torch.nn.Tanh()
    with pytest.raises(ValueError, match="the actor is Linear, Tanh, Linear"):
        library.converted(model, AS_REGISTERED)


def test_the_environment_beside_an_expert_is_our_task(tmp_path: Path) -> None:
    plan = short_plan(tmp_path)
    form = library.residual(plan)
    assert form.environment == PAPER
    insertion = InsertionTask(form.environment, form.expert, form.range_m)
    env = ExpertBeside(gymnasium.make(library.ENVIRONMENT, config=form.environment), form)
    pose = np.array([6e-6, 2e-6, 2.0e-3, 1e-3, 0.0])
    seen, _ = env.reset(seed=1, options={"pose": pose})
    key = env.unwrapped._core._key
    state = insertion.reset(Start(pose, key))
    generator = np.random.default_rng(1)
    ended = False
    while not ended:
        assert seen == pytest.approx(state, abs=1e-6)
        action = generator.uniform(-1.0, 1.0, 3).astype(np.float32)
        seen, reward, is_terminal, ended, _ = env.step(action)
        step = insertion.step(insertion.cut(insertion.expert(state) + action))
        state = step.state
        assert reward == pytest.approx(step.reward, abs=1e-6)
        assert not is_terminal
        assert ended == (step.outcome != Outcome.RUNNING)
    assert step.outcome == Outcome.INSERTED


def test_without_an_expert_our_answer_is_the_whole_step() -> None:
    plan = without_expert(load_analytic(Path("config/training/paper_analytic.yaml")))
    assert plan.expert == WHOLE_STEP
    assert [scale for _, scale in plan.settings.residual.outputs()] == [20e-6, 20e-6, 60e-6]


def test_ends_are_told_where_our_trainer_is_told(tmp_path: Path) -> None:
    telling = replace(BESIDE, ends=True)
    env = ExpertBeside(DualPegEnv(), telling)
    env.reset(seed=1, options={"pose": np.array([0.0, 0.0, 2.29e-3, 0.0, 0.0])})
    assert env.step(np.zeros(3, dtype=np.float32))[2:4] == (True, False)
    assert not library.residual(short_plan(tmp_path)).ends


def test_the_expert_alone_by_the_single_environment() -> None:
    quality = quality_of(zero_policy())
    assert quality.inserted == 1.0
    assert quality.steps == 47.0
    env = DualPegEnv()
    scores, rewards = [], []
    for pose in start_poses(10):
        seen, _ = env.reset(seed=1, options={"pose": pose})
        total, steps, ended = 0.0, 0, False
        while not ended:
            force_N = PAPER.force_N(seen)
            move = [-160e-6 * force_N[0], -160e-6 * force_N[1], 50e-6]
            seen, reward, ended, _, _ = env.step(PAPER.action(move))
            total, steps = total + reward, steps + 1
        scores.append(total / steps)
        rewards.append(total)
    assert quality_of(zero_policy(), 10).score == pytest.approx(np.mean(scores), rel=1e-6)
    assert quality_of(zero_policy(), 10).reward == pytest.approx(np.mean(rewards), rel=1e-6)


def test_what_fails_scores_nothing() -> None:
    forward = zero_policy(Expert(0.0, 60e-6, PAPER.step_box_m))
    quality = quality_of(forward)
    assert 0.0 < quality.inserted < 0.9
    assert 0.0 < quality.score < quality.inserted
    still = quality_of(zero_policy(WHOLE_STEP), 3)
    assert (still.inserted, still.score, still.steps) == (0.0, 0.0, 1000.0)
    assert still.reward > 400.0


def test_the_clock_stands_still_while_policies_are_judged() -> None:
    recorder = Recorder(began=0.0)
    began, cpu_began = time.perf_counter(), time.process_time()
    for steps in range(5):
        recorder.judge(steps, zero_policy(WHOLE_STEP))
    assert 0.0 < recorder.points[-1].wall_s < 0.5 * (time.perf_counter() - began)
    assert 0.0 < recorder.points[-1].cpu_s < 0.2 * (time.process_time() - cpu_began)
    assert recorder.startup_s > 0.0


def test_the_best_policy_is_kept() -> None:
    recorder = Recorder(began=0.0)
    good = zero_policy()
    for policy in (zero_policy(WHOLE_STEP), good, zero_policy(WHOLE_STEP), zero_policy()):
        recorder.judge(0, policy)
    assert recorder.best is good


def run(trainer: str, seed: int, *points: tuple[float, float, float]) -> Run:
    """A run with points of (wall_s, inserted, score)."""
    task = Task(trainer, "residual" if trainer in OURS else "direct", seed, 0, 1, Path())
    listed = [
        Point(
            round(100 * wall_s), wall_s, 0.5 * wall_s, Quality(inserted, score, 0.0, 0.0, 0.0, 0.0)
        )
        for wall_s, inserted, score in points
    ]
    return Run(task, 4.0, listed, zero_policy())


THEIRS = (
    run("td3", 0, (0.0, 0.0, 0.0), (30.0, 0.99, 0.97), (60.0, 1.0, 0.9), (90.0, 1.0, 0.8)),
    run("sac", 0, (0.0, 0.0, 0.0), (50.0, 1.0, 0.7), (99.0, 0.0, 0.0)),
)


@pytest.mark.parametrize(
    ("reached_s", "said"),
    [
        ((2.0, 3.0, 4.0), "3.00 s (median), 20.0 times less; aim 10: met"),
        ((2.0, 12.0, 40.0), "12.00 s (median), 5.0 times less; aim 10: missed"),
        ((0.0, 0.0, 9.0), "is there before it is trained, by its expert"),
        ((2.0, None, None), "does not reach it in half of the seeds; the aim is missed"),
    ],
)
def test_time_to_the_quality_of_their_best(reached_s: tuple[float | None], said: str) -> None:
    ours = [
        run(
            "analytic",
            seed,
            (0.0, 1.0, 0.9 if at == 0.0 else 0.5),
            (at or 1.0, 1.0, 0.95 if at else 0),
        )
        for seed, at in enumerate(reached_s)
    ]
    lines = [*result.lines([*ours, *THEIRS])]
    assert "Best of the library, direct: td3 direct, seed 0:" in lines
    assert f"  analytic residual: {said}" in lines


TWO = ((0, 3.0), (1, 5.0))
"""Seeds, and when they get better than the expert."""


def test_time_to_the_best_of_each() -> None:
    ours = [run("analytic", s, (0.0, 1.0, 0.6), (at, 1.0, 0.8), (9.0, 1.0, 0.95)) for s, at in TWO]
    idle = run("ddpg", 0, (0.0, 0.0, 0.0), (30.0, 0.0, 0.0))
    lines = [*result.lines([*ours, *THEIRS, idle])]
    assert "  td3 direct: score 0.9000 at 60.0; analytic residual 9.00 (6.7)" in lines
    assert "  sac direct: score 0.7000 at 50.0; analytic residual 4.00 (12.5)" in lines
    assert "  ddpg direct: inserts nothing" in lines


def test_table_of_times() -> None:
    lines = [*result.lines([run("analytic", 0, (0.0, 1.0, 0.91), (7.0, 1.0, 0.95)), *THEIRS])]
    rows = {line[:19].strip(): line.split()[2:] for line in lines[-3:]}
    assert rows == {
        "analytic residual": ["0.0", "0.0", "0.0", "0.0", "0.0", "7.0", "7.0", "-", "-"],
        "td3 direct": ["60.0", "60.0", "60.0", "60.0", "60.0", "-", "-", "-", "-"],
        "sac direct": ["50.0", "50.0", "50.0", "-", "-", "-", "-", "-", "-"],
    }


def test_the_whole_comparison(tmp_path: Path) -> None:
    out = tmp_path / "out"
    config = short_file(tmp_path, rounds=2)
    analytic = tmp_path / "analytic.yaml"
    shipped = Path("config/training/paper_analytic.yaml").read_text()
    plants = Path("config/randomisation/nominal.yaml").resolve()
    short = shipped.replace("../randomisation/nominal.yaml", str(plants))
    analytic.write_text(short.replace("updates: 100", "updates: 2"))
    options = "--steps 120 --every 60 --seeds 1 --algorithm sac"
    files = f"--config {config} --analytic {analytic} --out {out}"
    command = f"-m benchmarks.off_the_shelf {options} --every-round 1 {files}"
    done = subprocess.run(
        [sys.executable, *command.split()], capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("machine: ")
    assert f"command: python -m benchmarks.off_the_shelf {options}" in done.stdout
    assert re.search(r"sac residual +seed 0: 120 steps in [\d.]+ s", done.stdout)
    assert (out / "curves.csv").read_text().count("\n") == 1 + 3 + 2 * 3 + 2 * 3
    for name in ("sac-direct", "sac-residual"):
        policy = load_policy(out / f"{name}.safetensors")
        assert policy.expert.axial_step_m == (50e-6 if "residual" in name else 0.0)
    assert (out / "quality-against-time.png").stat().st_size > 10_000
