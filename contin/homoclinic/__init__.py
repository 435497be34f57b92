"""Homoclinic and heteroclinic orbits in two parameters, by collocation with projection boundary conditions."""
