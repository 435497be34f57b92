"""Equilibria of flows, fixed points of maps, solutions of algebraic equations, in one parameter."""
