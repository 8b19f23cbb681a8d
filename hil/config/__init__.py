"""The configuration of a cell: YAML files in, validated settings in SI units out."""

from hil.config.load import CellConfig, DeviceConfig, load_cell

__all__ = ["CellConfig", "DeviceConfig", "load_cell"]
