"""Solutions that meet conditions, with as many parameters solved for as there are conditions."""
