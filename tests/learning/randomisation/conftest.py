from tests.learning.randomisation.plant_files import load, refuse

__all__ = ["load", "refuse"]
