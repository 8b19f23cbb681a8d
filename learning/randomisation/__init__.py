"""What simulated plants are drawn from: a YAML file in, distributions in SI units out."""

from learning.randomisation.load import load_randomisation

__all__ = ["load_randomisation"]
