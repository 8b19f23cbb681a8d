"""Grippers that hold the part."""
