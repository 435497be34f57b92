"""Users' Python functions as systems: what they give, what is differenced."""
