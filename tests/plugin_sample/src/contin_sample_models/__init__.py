"""Models for contin: the files in this folder are offered as sample/NAME."""
