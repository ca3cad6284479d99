"""Sweeps: one case with many values of some of its keys, on any number of threads, processes or machines."""
