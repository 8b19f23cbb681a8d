"""Devices behind one contract, each also as a mock over one simulated world."""
