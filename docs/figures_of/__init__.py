"""The figures of README and docs, one module each, with a `draw()` that returns SVG text."""
