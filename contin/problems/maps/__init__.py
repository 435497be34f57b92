"""Maps: the iterated map, cycles as its fixed points, doubled cycles."""
