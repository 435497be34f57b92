"""AUTO-07p's equations files and files of constants."""
