"""How figures look: fonts, colours, and the way to SVG."""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib as mpl
from matplotlib.figure import Figure

AXIS_COLOURS = ("#0072B2", "#D55E00", "#009E73")
"""Of x, y and z: three that the colour-blind tell apart (Okabe and Ito)."""
BAND_COLOUR = "#DDF0E6"
RADIAL_COLOUR = "#555555"
LIMIT_COLOUR = "#A00000"
WALL_COLOUR = "#E6E3DA"

_NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


@contextmanager
def drawing() -> Iterator[None]:
    """Draw inside with the report's fonts and colours, whatever the user's own settings are."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(
            {
                "svg.fonttype": "none",
                "svg.hashsalt": "tenon",
                "font.family": "sans-serif",
                "font.sans-serif": ["DejaVu Sans"],
                "font.size": 9.0,
                "axes.titlesize": 10.0,
                "axes.titleweight": "bold",
                "axes.titlelocation": "left",
                "axes.labelsize": 9.0,
                "axes.spines.top": False,
                "axes.spines.right": False,
                "axes.axisbelow": True,
                "legend.frameon": False,
                "legend.fontsize": 8.5,
                "lines.linewidth": 1.3,
                "text.parse_math": False,
                "path.simplify": False,
            }
        )
        yield


def svg(figure: Figure, name: str, description: str) -> str:
    """Return a figure as an SVG element that can stand beside others in one page.

    The same figure gives the same text. Its ids begin with `name`; `description` is for those who
    cannot see it.
    """
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata=_NO_METADATA)
    text = stream.getvalue()
    text = text[text.index("<svg ") :]
    text = re.sub(r'( id="| xlink:href="#|url\(#)', rf"\g<1>{name}-", text)
    return text.replace("<svg ", f'<svg role="img" aria-label="{description}" ', 1)


def alone(drawn: str) -> str:
    """Return an SVG element as a file of its own."""
    return f'<?xml version="1.0" encoding="utf-8"?>\n{drawn}'
