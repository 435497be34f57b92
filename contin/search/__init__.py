"""Where continuation starts: equilibria from guesses and in boxes, orbits from simulations and samples, responses."""
