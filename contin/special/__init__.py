"""The types of special points: one table, one leaf file a type."""
