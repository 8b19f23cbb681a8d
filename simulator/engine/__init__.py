"""The contact model for batches of poses, compiled: one source for the CPU and the GPU.

`simulator.contact` defines the model and is the reference; this package repeats its results for
millions of poses a second. Functions of numbers (`scalar`) carry the mathematics. On the CPU a
kernel runs blocks of poses ("lanes"), ordered by depth, through them, one contact candidate after
the other: it solves the lanes from the first to the last that can touch, in vectors, and hands the
few that need a search to scalar code. On the GPU a thread runs one pose through the same functions.
"""
