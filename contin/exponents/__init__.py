"""Lyapunov exponents: mean growth rates of small disturbances along a trajectory."""
