"""Trajectories, hysteresis sweeps, brute-force scans."""
