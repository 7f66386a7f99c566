"""Sections of any listed family through noisy readings: batched over rings, robust, within the family's limits."""

from .models import MODELS
from .results import SectionFits
from .sections import fit_section

__all__ = ["MODELS", "SectionFits", "fit_section"]
