"""What happens between two points of a curve: detection, location and verification of events, bounds, returns."""
