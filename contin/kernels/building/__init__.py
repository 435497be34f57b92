"""Kernels to machine code, with numba, in processes of their own (`python -m contin.kernels.building`)."""
