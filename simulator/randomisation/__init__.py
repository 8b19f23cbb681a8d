"""Plants that differ: a distribution of each of their parameters, and draws from it.

Chance comes from one generator per environment, so that environment i gets the same plant, to the
last bit, however many others are drawn beside it. A parameter takes the same numbers from its
generator whatever its distribution: with the same seeds, a parameter that is not changed keeps its
values when another's distribution is.
"""
