"""Reads a report as a strict XML parser and a reader do."""

import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from hil.log_reader import Log
from hil.report import write_report

_SVG = "{http://www.w3.org/2000/svg}svg"


@dataclass(frozen=True)
class Page:
    """A report, read."""

    source: str
    root: ElementTree.Element

    @property
    def text(self) -> str:
        """All text, with single spaces."""
        return " ".join(" ".join(self.root.itertext()).split())

    @property
    def headings(self) -> list[str]:
        return [e.text or "" for e in self.root.iter() if e.tag.endswith("}h2")]

    @property
    def headline(self) -> str:
        """Whether the headline is "good" or "bad"."""
        (found,) = (e for e in self.root.iter() if e.tag.endswith("}h1"))
        return found.get("class") or ""

    @property
    def banner(self) -> list[str]:
        boxes = [e for e in self.root.iter() if e.get("class") == "banner"]
        return [" ".join(p.itertext()) for box in boxes for p in box]

    def figure(self, label: str) -> str:
        """The text in the one figure whose description begins so."""
        (found,) = (
            e for e in self.root.iter(_SVG) if (e.get("aria-label") or "").startswith(label)
        )
        return " ".join(" ".join(found.itertext()).split())

    @property
    def ids(self) -> list[str]:
        return [e.attrib["id"] for e in self.root.iter() if "id" in e.attrib]

    @property
    def references(self) -> set[str]:
        """The ids that the page refers to."""
        return set(re.findall(r'(?:href="|url\()#([^")]+)', self.source))


def report(log: Log, folder: Path, compared_with: Log | None = None) -> Page:
    """Write the report of a log, and read it."""
    path = folder / "report.html"
    write_report(log, path, compared_with)
    source = path.read_text("utf-8")
    return Page(source, ElementTree.fromstring(source))  # noqa: S314
