"""What can be typed: one function a command, whose work is in its own file and is imported only when it runs."""
