"""MatCont's system files."""
