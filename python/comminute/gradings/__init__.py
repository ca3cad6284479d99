"""Sieve tables, grading curves and their indices."""
