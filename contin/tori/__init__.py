"""Invariant tori of flows: invariant circles of their return maps, by Fourier collocation."""
