"""Learning to insert: environments to learn in."""
