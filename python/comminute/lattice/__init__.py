"""The stochastic lattice and its results."""
