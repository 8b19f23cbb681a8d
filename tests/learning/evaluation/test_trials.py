"""Insertions side by side: the same plants and chance for all, however the work is shared."""

from collections.abc import Iterator

import numpy as np
import pytest

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from learning.evaluation.contenders import Proportional
from learning.evaluation.plant import Plant, drawn_plants
from learning.evaluation.trial import Record, Trial, TrialRules
from learning.evaluation.trials import cases_of, insert_each, workers
from learning.randomisation import load_randomisation
from tests.learning.evaluation.records import ROOT

RULES = TrialRules()
DISTRIBUTION = load_randomisation(ROOT / "config/randomisation/extended.yaml")


class _Watching(Controller):
    def __init__(self, own_draws: int, generator: np.random.Generator) -> None:
        self._own_draws = own_draws
        self._generator = generator
        self.seen: list[Observation] = []

    def think(self, observation: Observation) -> Iterator[None]:
        self.seen.append(observation)
        self._generator.random(self._own_draws)
        yield

    def step(self, observation: Observation) -> Move:
        return Move((0.0, 0.0, 60e-6))


class _Watch:
    """Goes straight on, takes so many random numbers at each step, and keeps what it sees."""

    def __init__(self, own_draws: int) -> None:
        self._own_draws = own_draws
        self.made: list[_Watching] = []

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        self.made.append(_Watching(self._own_draws, generator))
        return self.made[-1]


def same(first: list[Record], second: list[Record]) -> bool:
    return len(first) == len(second) and all(
        np.array_equal(a.poses, b.poses) and np.array_equal(a.wrenches, b.wrenches)
        for a, b in zip(first, second, strict=True)
    )


def test_controllers_see_the_same_noise_whatever_they_draw() -> None:
    cases = cases_of(drawn_plants(DISTRIBUTION, 2, 3), 3)
    one, other = _Watch(0), _Watch(7)
    first, second = insert_each(one, cases, RULES), insert_each(other, cases, RULES)
    assert same(first, second)
    for a, b in zip(one.made, other.made, strict=True):
        assert a.seen == b.seen
    # And not the same on every plant.
    assert one.made[0].seen[0].wrench != one.made[1].seen[0].wrench


def test_a_case_does_not_depend_on_how_many_there_are() -> None:
    few = insert_each(
        Proportional(40e-6, 60e-6), cases_of(drawn_plants(DISTRIBUTION, 2, 3), 3), RULES
    )
    many = insert_each(
        Proportional(40e-6, 60e-6), cases_of(drawn_plants(DISTRIBUTION, 4, 3), 3), RULES
    )
    assert same(few, many[:2])
    assert not same(many[:2], many[2:])


@pytest.mark.slow
def test_records_do_not_depend_on_the_number_of_processes() -> None:
    cases = cases_of(drawn_plants(DISTRIBUTION, 11, 3), 3)
    contenders = [Proportional(40e-6, 60e-6), Proportional(90e-6, 50e-6)]
    found, told = [], []
    for count in (1, 3):
        heard: list[int] = []
        with workers(count) as team:
            found.append(team.insert(contenders, cases, RULES, heard.append))
        told.append(sum(heard))
    assert told == [22, 22]
    for one, other in zip(*found, strict=True):
        assert same(one, other)
    assert same(found[0][1], insert_each(contenders[1], cases, RULES))
