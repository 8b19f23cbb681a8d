"""Draws the figures of README and docs: python docs/make_figures.py [name ...]."""

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import numpy.typing as npt
from figures_of import (
    belief,
    chamfer_map,
    contact_kinds,
    contact_states,
    cut_circle,
    environment,
    extremum,
    faces,
    force_map,
    frames,
    jamming,
    mock_cell,
    ring,
)
from matplotlib.image import imsave

FOLDER = Path(__file__).parent / "figures"
FIGURES: Mapping[str, Callable[[], str]] = MappingProxyType(
    {
        "insertion": mock_cell.draw_insertion,
        "stop": mock_cell.draw_stop,
        "frames": frames.draw,
        "contact-kinds": contact_kinds.draw,
        "extremum": extremum.draw,
        "faces": faces.draw,
        "cut-circle": cut_circle.draw,
        "ring": ring.draw,
        "contact-states": contact_states.draw,
        "force-map": force_map.draw,
        "chamfer-map": chamfer_map.draw,
        "jamming": jamming.draw,
        "belief": belief.draw,
    }
)
PICTURES: Mapping[str, Callable[[], npt.NDArray[np.uint8]]] = MappingProxyType(
    {"environment": environment.draw}
)


def main(names: list[str]) -> None:
    """Write the named figures, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in names or [*FIGURES, *PICTURES]:
        if name in PICTURES:
            imsave(FOLDER / f"{name}.png", PICTURES[name]())
        else:
            (FOLDER / f"{name}.svg").write_text(FIGURES[name](), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
