"""The data contract: a `Survey` is a thin view over an `xarray.DataTree`, stored as zarr."""

from .files import open_survey, save_survey
from .model import Survey
from .provenance import InputFile, add_assumption, add_inputs, add_provenance, add_run, add_warning, fingerprint
from .schema import validate
from .stream import save_blocks

__all__ = [
    "InputFile",
    "Survey",
    "add_assumption",
    "add_inputs",
    "add_provenance",
    "add_run",
    "add_warning",
    "fingerprint",
    "open_survey",
    "save_blocks",
    "save_survey",
    "validate",
]
