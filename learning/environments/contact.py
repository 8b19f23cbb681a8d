"""The one place where environments ask for contact."""

from simulator.checks import FloatArray
from simulator.contact import ContactLaw
from simulator.engine.batch import Batch
from simulator.engine.solve import solve
from simulator.engine.table import Table


def write_contacts(
    table: Table,
    law: ContactLaw,
    poses: FloatArray,
    travel: FloatArray,
    contacts: Batch,
    rows: slice,
) -> None:
    """Write the contacts of a block of poses (n, 5), reached by the translations `travel` (n, 3).

    A shaft that has just moved slides that way; one that has not has no friction.
    """
    found = Batch(
        contacts.wrench[rows],
        contacts.penetration[rows],
        contacts.state[rows],
        contacts.points[rows],
    )
    solve(
        table,
        poses[rows],
        travel[rows],
        stiffness_N_m=law.stiffness_N_m,
        friction=law.friction,
        out=found,
    )
