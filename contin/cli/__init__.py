"""The `contin` command; outermost, imports everything lazily."""
