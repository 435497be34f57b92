"""SBML (Systems Biology Markup Language), levels 1 to 3, through python-libsbml."""
