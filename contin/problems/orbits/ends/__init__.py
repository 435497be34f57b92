"""Where families of orbits end: at Hopf points, homoclinic orbits, invariant circles; where they stand still."""
