"""Phase diagrams: a box of two parameters cut into regions by curves of special points."""
