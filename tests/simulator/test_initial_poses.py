"""Initial poses: bounds, distribution and reproducibility."""

import numpy as np

from simulator.initial_pose import initial_poses


def draw(n: int = 20_000, seed: int = 3) -> np.ndarray:
    return initial_poses(n, 1e-5, 5e-3, -2e-4, np.random.default_rng(seed))


def test_errors_stay_inside_their_discs() -> None:
    poses = draw()
    assert poses.shape == (20_000, 5)
    assert (poses[:, 2] == -2e-4).all()
    assert np.hypot(poses[:, 0], poses[:, 1]).max() <= 1e-5
    assert np.hypot(poses[:, 3], poses[:, 4]).max() <= 5e-3


def test_both_errors_are_uniform_in_their_discs() -> None:
    """Uniform in a disc: the squared radius and the angle are uniform and independent."""
    poses = draw()
    for pair, radius in ((poses[:, :2], 1e-5), (poses[:, 3:], 5e-3)):
        square = (pair**2).sum(axis=1) / radius**2
        turn = np.arctan2(pair[:, 1], pair[:, 0]) / (2.0 * np.pi) + 0.5
        for sample in (square, turn):
            steps = np.sort(sample) - np.linspace(0.0, 1.0, len(sample))
            # Kolmogorov-Smirnov at a level of about 1e-6.
            assert np.abs(steps).max() * np.sqrt(len(sample)) < 2.7
        assert abs(np.corrcoef(square, turn)[0, 1]) < 0.03


def test_offset_and_tilt_are_independent() -> None:
    poses = draw()
    assert np.abs(np.corrcoef(poses[:, [0, 1, 3, 4]].T) - np.eye(4)).max() < 0.03


def test_the_generator_decides() -> None:
    np.testing.assert_array_equal(draw(5), draw(5))
    assert (draw(5) != draw(5, seed=4)).any()
    assert initial_poses(0, 1e-5, 0.0, 0.0, np.random.default_rng(0)).shape == (0, 5)
