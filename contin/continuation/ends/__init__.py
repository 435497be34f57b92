"""Where following a branch further is of no use, or has no meaning: why an arm ends."""
