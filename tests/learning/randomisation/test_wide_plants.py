"""From the shipped file to contact forces and equilibria, plant by plant."""

import numpy as np
import pytest

from learning.randomisation import load_randomisation
from simulator.contact import solve
from simulator.equilibrium import settle, sliding_contact
from simulator.randomisation.plants import Plants, draw_plants
from tests.hil.config.cell_files import ROOT

DOWN = np.array([0.0, 0.0, 1.0])
DEPTHS_M = [-5e-5, 2e-6, 1e-5, 2.5e-4, 1.2e-3, 2.4e-3, 3.2e-3]
"""Above the part, at its first mouth, and on through both holes."""


@pytest.fixture(scope="module")
def plants() -> Plants:
    distribution = load_randomisation(ROOT / "config" / "randomisation" / "wide.yaml")
    return draw_plants(distribution, [np.random.default_rng(seed) for seed in range(300)])


@pytest.mark.slow
def test_every_plant_has_finite_contact_forces(plants: Plants) -> None:
    """Nothing touches above the part; below, nearly all do, for the tilt is not corrected."""
    force_N = np.empty((300, len(DEPTHS_M)))
    for i, misalignment in enumerate(plants.misalignment):
        part, shaft = plants.part(i), plants.shaft(i)
        assert not part.is_plain
        assert not shaft.is_plain
        poses = np.tile(misalignment, (len(DEPTHS_M), 1))
        poses[:, 2] = DEPTHS_M
        contacts = solve(part, shaft, poses, DOWN, plants.law(i))
        assert np.isfinite(contacts.wrench).all()
        assert np.isfinite(contacts.energy).all()
        force_N[i] = np.hypot(contacts.wrench[:, 0], contacts.wrench[:, 1])
    assert force_N[:, 0].max() == 0.0
    assert (force_N[:, -1] > 1e-3).mean() > 0.9
    assert force_N.max() < 1.0


@pytest.mark.slow
def test_held_parts_come_to_rest(plants: Plants) -> None:
    """Force balance in each axis, which shifts or turns by its compliance times its load."""
    pressed = 0
    for i in range(8):
        poses = np.tile(plants.misalignment[i], (len(DEPTHS_M), 1))
        poses[:, 2] = DEPTHS_M
        holder = plants.holder(i)
        contact = sliding_contact(plants.part(i), plants.shaft(i), DOWN, plants.law(i))
        found = settle(holder, np.zeros(5), poses, contact)
        assert found.converged.all()
        assert (np.abs(found.holder_force[:, 0]) <= holder.holding_force[0]).all()
        np.testing.assert_allclose(
            found.displacement - found.offset, holder.compliance * found.holder_force, atol=1e-15
        )
        pressed += int((np.abs(found.displacement[:, 0]) > 1e-8).sum())
    assert pressed > 20
