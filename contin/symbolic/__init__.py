"""Passes: pure functions Model -> Model, each in its own file."""
