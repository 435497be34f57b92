"""The compiled march of a family, and what its rows hold."""
