"""What can be continued: equilibria, fixed points of maps, orbits, loci, user functions."""
