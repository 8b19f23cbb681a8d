"""Ways of a real rig, one small model each: stage, arm and force sensor.

Each is a frozen set of parameters and functions of arrays that share a leading batch shape (...),
one entry per environment. What an effect remembers is a value: it is passed in and the new one is
returned. Every effect can be off, and what is off changes nothing.

Chance comes in as standard normal draws, an array of the batch's shape and as many numbers per
environment as the effect says. Whoever makes them takes them from one generator per environment
(`simulator.effects.draws`), so that environment i sees the same numbers however many others run
beside it. Only elementwise arithmetic and sums in a fixed order follow, so that its results are the
same to the last bit too.

Sizes (gaps, amplitudes, densities) may have the leading shape of the batch, so that environments
differ; time constants, frequencies and counts are shared by a batch.
"""
