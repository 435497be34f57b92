"""What can be continued in one parameter: equilibria, cycles of maps, periodic orbits, large systems."""
