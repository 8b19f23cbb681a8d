"""Largest differences between the engine and the numpy reference."""

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.contact import ContactLaw, Contacts
from simulator.contact import solve as reference
from simulator.engine.batch import Batch
from simulator.engine.solve import solve
from simulator.engine.table import tabulate
from simulator.geometry import Part, Shaft
from simulator.states import contact_states, phase_codes, touching_stations


def difference(
    part: Part,
    shaft: Shaft,
    poses: FloatArray,
    sliding: FloatArray,
    law: ContactLaw,
    entered: npt.NDArray[np.bool_] | None = None,
) -> float:
    """Of wrenches and penetrations, relative to the largest force and its arm; inf if states or
    points differ where the penetration is not a matter of rounding."""
    after = None if entered is None else entered.copy()
    batch = solve(
        tabulate([(part, shaft)]),
        poses,
        sliding,
        stiffness_N_m=law.stiffness_N_m,
        friction=law.friction,
        entered=after,
    )
    contacts = reference(part, shaft, poses, sliding, law, entered=after)
    return compared(batch, contacts, part, shaft, poses)


def compared(
    batch: Batch, contacts: Contacts, part: Part, shaft: Shaft, poses: FloatArray
) -> float:
    penetration = contacts.penetration.max(axis=-1)
    largest = float(penetration.max())
    force = contacts.law.stiffness_N_m * largest
    scale = np.repeat([force, force * shaft.length_m], 3)
    phases = phase_codes(part, poses[:, 2])
    doubtful = ((contacts.penetration > 0.0) & (contacts.penetration < 1e-12 * largest)).any(-1)
    same = batch.state == contact_states(contacts, phases)
    same &= batch.points == touching_stations(contacts).sum(axis=(-2, -1))
    if not (same | doubtful).all():
        return np.inf
    if largest == 0.0:
        return float(np.abs(batch.wrench).max() + batch.penetration.max())
    wrench = (np.abs(batch.wrench - contacts.wrench) / scale).max()
    return float(max(wrench, np.abs(batch.penetration - penetration).max() / largest))
