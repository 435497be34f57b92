"""Numbers of an orbit: integrals, extrema, amplitude, norm, and their derivatives."""
