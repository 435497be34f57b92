"""Trajectories of piecewise-smooth flows: every smooth piece integrated with its own field, crossings landed on."""
