"""Normal forms of special orbits and eigenfunctions of multipliers."""
