"""The stochastic lattice: its state, its walk along a load path, and the exact operator of a small ring."""
