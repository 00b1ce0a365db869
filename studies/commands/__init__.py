"""What each command of `twinecho` does, and what it shows."""
