"""Contact as a step of a network: wrenches forward, their derivatives backward.

The derivatives are differences of the contact model's own answers, all poses in one batch.
"""

import numpy as np
import torch
from torch import Tensor

from learning.analytic.plant_batch import PlantBatch

_SHIFTS = np.array([1e-8, 1e-8, 1e-8, 1e-6, 1e-6])
"""Along each axis of a pose [m, rad]: far above rounding, far below what changes a contact."""


def wrench_after(pose: Tensor, step: Tensor, plants: PlantBatch) -> Tensor:
    """Return the wrenches (n, 6) on the parts about the origin of M after a step of each shaft.

    `pose` (n, 5) is where the shafts are in M; `step` (n, 3) or (n, 5) moves them along the first
    axes of their pose. Friction is against the translation. The answer has derivatives by both
    where gradients are asked for.
    """
    axes = step.shape[1] if pose.requires_grad or step.requires_grad else 0
    before, made = pose.detach().numpy(), np.zeros(pose.shape)
    made[:, : step.shape[1]] = step.detach().numpy()
    # First the pose itself, then shifted before the step, then by a step that is longer.
    poses = np.repeat((before + made)[np.newaxis], 1 + 2 * axes, axis=0)
    travel = np.repeat(made[np.newaxis, :, :3], 1 + 2 * axes, axis=0)
    for axis in range(axes):
        for shifted in (1 + axis, 1 + axes + axis):
            poses[shifted, :, axis] += _SHIFTS[axis]
        if axis < 3:
            travel[1 + axes + axis, :, axis] += _SHIFTS[axis]
    found = plants.wrenches(poses, travel)
    wrench = torch.from_numpy(found[0])
    if not axes:
        return wrench
    slopes = (found[1:] - found[0]) / np.tile(_SHIFTS[:axes], 2)[:, np.newaxis, np.newaxis]
    moved = torch.cat((pose[:, :axes], step), 1)
    # Zero, but with the slopes as its derivative.
    change = torch.einsum("na,anw->nw", moved - moved.detach(), torch.from_numpy(slopes))
    return wrench + change


def cut(values: Tensor) -> Tensor:
    """Return the values, cut to -1 .. 1.

    Where one was cut, descent along a gradient may lead it back inside but not further out. The
    gradient of `clamp` is zero either way, so what was cut once would stay cut.
    """
    within = values + (values.clamp(-1.0, 1.0) - values).detach()
    if values.requires_grad:
        known = values.detach()

        def inwards(gradient: Tensor) -> Tensor:
            out = ((known > 1.0) & (gradient < 0.0)) | ((known < -1.0) & (gradient > 0.0))
            return gradient.masked_fill(out, 0.0)

        values.register_hook(inwards)  # type: ignore[no-untyped-call]  # torch gives it no types
    return within
