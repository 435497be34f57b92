"""Equilibria at surfaces where the equations jump: where a branch meets one, and the sliding motion beyond."""
