"""Controllers compared on plants: insertions in simulation and what they are measured by."""
