"""Readers and writers: one file per format, and a registry that guesses by content and can be overruled."""
