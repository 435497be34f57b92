"""Machine code that everything else may call, the same on every processor: target levels and elementary functions."""
