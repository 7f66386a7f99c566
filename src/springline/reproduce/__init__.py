"""The dissertation's tables and figures made again, beside what was printed, with the reason for every difference."""
