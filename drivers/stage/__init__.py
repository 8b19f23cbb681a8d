"""Stages that carry the shaft."""
