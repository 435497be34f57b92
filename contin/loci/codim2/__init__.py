"""Points of codimension two on those curves: detection, verification, normal forms."""
