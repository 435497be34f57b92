"""The phase plane: nullclines, direction field, equilibria, separatrices, cycles and trajectories of two states."""
