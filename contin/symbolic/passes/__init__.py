"""Passes other than averaging: Model -> Model, each in its own file."""
