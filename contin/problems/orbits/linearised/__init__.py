"""The linearised collocation equations, and multipliers from them."""
