"""Large systems: sparse or matrix-free Jacobians; bordered solves by block elimination, stability by Arnoldi."""
