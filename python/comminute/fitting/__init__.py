"""Parameters from measured gradings: the problem, its solution, and how well its parameters are known. Needs scipy."""
