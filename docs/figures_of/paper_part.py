"""Shaft and part of the paper's simulation."""

from simulator.geometry import Hole, Part, Shaft

SHAFT = Shaft(diameter_m=1.00e-3, length_m=4e-3)
PART = Part((Hole(1.01e-3, 0.5e-3), Hole(1.01e-3, 0.5e-3, gap_m=1.5e-3)))
