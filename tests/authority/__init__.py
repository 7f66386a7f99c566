"""Reference vectors of independent programs, run against the public functions."""
