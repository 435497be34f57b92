"""How orbits are stored on a mesh, and the mesh adapted."""
