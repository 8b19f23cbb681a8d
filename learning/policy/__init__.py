"""Trained policies: what they see and answer, how they are computed, stored and exported."""
