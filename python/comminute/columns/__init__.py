"""Columns: rows of the stochastic lattice that mix, segregate and crush (Section 8.3)."""
