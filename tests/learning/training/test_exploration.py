import numpy as np
import pytest

from learning.exploration import Exploration
from learning.settings import ExplorationSettings

SETTINGS = ExplorationSettings(sigma_first=0.2, sigma_success=0.1, sigma_failure=0.4)


def test_success_narrows_and_failure_widens() -> None:
    exploration = Exploration.first(SETTINGS)
    assert exploration.sigma == 0.2
    exploration.conclude(succeeded=True)
    assert exploration.sigma == 0.1
    exploration.conclude(succeeded=False)
    assert exploration.sigma == 0.4
    exploration.conclude(succeeded=True)
    assert exploration.sigma == 0.1


@pytest.mark.parametrize("sigma", [0.0, 0.1, 0.4])
def test_noise_is_gaussian_with_sigma(sigma: float) -> None:
    rng = np.random.default_rng(1)
    exploration = Exploration(SETTINGS, sigma)
    noise = np.array([exploration.noise(3, rng) for _ in range(4000)])
    # Standard errors of mean and deviation are 0.016 and 0.011 sigma.
    assert np.abs(noise.mean(axis=0)).max() <= 0.07 * sigma
    assert noise.std(axis=0) == pytest.approx([sigma] * 3, rel=0.05)
    assert abs(np.corrcoef(noise.T)[0, 1]) < 0.07 if sigma else (noise == 0.0).all()
