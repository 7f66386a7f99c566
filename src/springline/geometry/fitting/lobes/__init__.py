"""Lobes of liners found in noisy readings: whether a ring shows one, at a stated false-alarm rate, and its shape."""

from .evidence import false_alarm_rate
from .fit import fit_lobe
from .results import NAMES, LobeFits
from .wall import KINDS

__all__ = ["KINDS", "NAMES", "LobeFits", "false_alarm_rate", "fit_lobe"]
