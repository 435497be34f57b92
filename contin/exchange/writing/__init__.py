"""Models as equations in other languages."""
