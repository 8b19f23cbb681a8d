"""Training of a skill: what a file asks for, the rounds, checkpoints, and the policy at the end."""
