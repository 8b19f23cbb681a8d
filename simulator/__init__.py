"""Analytic simulator of a rigid shaft in elastic thin walls.

Geometry, contact, stage response, force sensor.

Pure functions of arrays, in SI units. Random draws come from a `numpy.random.Generator` that the
caller passes in; nothing here reads a clock, starts a thread or touches a file.
"""
