"""Columns: rows that mix, segregate and crush, of lattice cells or of the law of three (Section 8.3)."""
