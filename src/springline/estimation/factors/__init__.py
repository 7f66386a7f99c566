"""Measurements and priors, one per file: each joins two neighbouring knots and the survey's scalars."""
