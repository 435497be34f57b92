"""What a system is: expressions, models, YAML loading, the registry of models."""
