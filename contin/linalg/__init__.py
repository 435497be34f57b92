"""Linear algebra that problems share: factors, Krylov methods, bordered systems, spectra, Newton's method."""
