"""What a scenario file may say: the pipe, the robot, its sensors and the known points.

A scenario is one TOML file; these models are its schema, and their field descriptions its manual. Lengths are metres
(or text with a unit, "300mm"), angles are degrees and carry `_deg` in their name, clocks are hours looking forward.
"""

from __future__ import annotations

from pydantic import Field

from .equipment import DepthCamera, Inertial, Odometer, RingScanner, Robot, Ties
from .optics import Camera
from .pipes import Pipe
from .quantities import Part, PositiveLength


class Scenario(Part):
    """A whole scenario."""

    name: str
    description: str = ""
    date: str = Field("", description="of the inspection, ISO 8601")
    pipe: Pipe
    robot: Robot = Robot()
    rings: RingScanner | None = None
    rings_rear: RingScanner | None = None
    depth_camera: DepthCamera | None = None
    inertial: Inertial | None = None
    odometer: Odometer = Odometer()
    ties: Ties | None = None
    camera: Camera | None = None
    truth_spacing: PositiveLength = Field(0.05, description="of the stations at which the true section is recorded")
