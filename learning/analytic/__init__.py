"""Analytic policy gradient: a skill learned by the gradient through the contact simulation."""
