"""Brute-force scans: a grid over parameters or initial states, several starts each, run to a steady state and named."""

from contin.simulate.scan.carry_out import scan

__all__ = ["scan"]
