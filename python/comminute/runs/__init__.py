"""Load paths, the engines that take them, and what a run is made of."""
