"""The axis of a pipe in a cloud of points, rings about it, and their sections.

`locate_pipe` finds the pipe and cuts it into rings; `pool_sections` gives the mean section of rings about one axis with
an honest sigma, `sections_about_axis` the section of each, and `mean_over_stations` the mean of sections that were
fitted one by one.
"""

from springline.geometry.axis.centreline import Centreline, Placed
from springline.geometry.axis.locate import Located, locate_pipe
from springline.geometry.axis.mean import mean_over_stations
from springline.geometry.axis.pooled import PooledSection, pool_sections
from springline.geometry.axis.sections import sections_about_axis
from springline.geometry.axis.stations import Stations

__all__ = [
    "Centreline",
    "Located",
    "Placed",
    "PooledSection",
    "Stations",
    "locate_pipe",
    "mean_over_stations",
    "pool_sections",
    "sections_about_axis",
]
