"""What is born at special points: one leaf file each, found by its name and registered by a decorator."""
