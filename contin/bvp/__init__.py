"""Boundary-value problems on an interval, with conditions at its ends and on integrals."""
