"""The engine: problem contract, walking, events, location, branches. It knows nothing of models, plots or files."""
