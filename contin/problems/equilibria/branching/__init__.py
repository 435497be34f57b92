"""How branches of equilibria leave a branch point that the leading terms of the reduced equations do not resolve."""
