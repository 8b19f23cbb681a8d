"""From force sample to command: filter, skill, supervisor and gate."""
