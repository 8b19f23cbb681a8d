from tests.hil.config.cell_files import load, refuse

__all__ = ["load", "refuse"]
