"""The robot and the sensors that a scenario describes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .quantities import (
    Length,
    NonNegative,
    NonNegativeLength,
    Number,
    Part,
    PositiveLength,
    Share,
    Small,
    Triple,
    Varying,
    VaryingLength,
)


class Standstill(Part):
    """A stop."""

    chainage: Length
    duration: float = Field(gt=0.0, le=1e6)


class Knock(Part):
    """A blow to the robot: deviations that come and go within `length`."""

    chainage: Length
    length: PositiveLength
    offset_y: Length = 0.0
    offset_z: Length = 0.0
    pitch_deg: Small = 0.0
    yaw_deg: Small = 0.0
    roll_deg: Annotated[float, Field(ge=-90.0, le=90.0)] = 0.0


class Robot(Part):
    """The robot and how it drives."""

    length: PositiveLength = 0.4
    wheelbase: PositiveLength = 0.3
    wheel_radius: PositiveLength = 0.03
    half_span: PositiveLength = Field(0.05, description="half the distance between left and right wheels")
    ride_height: PositiveLength | None = Field(
        None, description="of its axis above the wheels' contact; default: on the axis of the round pipe"
    )
    path: Literal["prescribed", "kinematic"] = "prescribed"
    follow: bool = Field(True, description="prescribed: point where it goes, attitudes added to that")
    offset_y: VaryingLength = 0.0
    offset_z: VaryingLength = 0.0
    pitch_deg: Varying = 0.0
    yaw_deg: Varying = 0.0
    roll_deg: Varying = 0.0
    climb_deg: Varying = Field(0.0, description="kinematic: angle about the pipe's axis by which it climbs sideways")
    side_slip_deg: Small = Field(0.0, description="nose right of where it goes")
    from_end: bool = Field(False, description="drive from the pipe's end to its start")
    returns: bool = Field(False, description="drive out and be pulled back, the counter coming back too")
    backwards: bool = Field(False, description="its nose points against its travel, as when it is pulled back")
    start: Length | None = Field(None, description="distance from where it enters; default: half its length")
    end: Length | None = None
    speed: float = Field(0.1, ge=1e-6, le=10.0, description="m/s")
    standstill: tuple[Standstill, ...] = ()
    knock: tuple[Knock, ...] = ()


class RingScanner(Part):
    """A ring scanner."""

    spacing: PositiveLength = Field(0.01, description="of odometer readings between rings")
    bearings: int = Field(360, ge=8, le=8192)
    position: Triple = Field((0.0, 0.0, 0.0), description="in robot axes: ahead, up, right of the robot's middle")
    noise: NonNegativeLength = 0.001
    noise_relative: NonNegative = 0.0
    outliers: Share = 0.0
    dropout: Share = 0.0
    blind_deg: tuple[tuple[Number, Number], ...] = Field((), description="bearings hidden by the robot itself")
    water_returns: Share = Field(0.5, description="share of readings that water sends back")
    resolution: NonNegativeLength = 0.0
    range_min: NonNegativeLength = 0.02
    range_max: PositiveLength = 5.0
    scale_error: Annotated[float, Field(ge=-0.2, le=0.2)] = 0.0
    boresight_pitch_deg: Small = 0.0
    boresight_yaw_deg: Small = 0.0
    boresight_roll_deg: Small = 0.0


class DepthCamera(Part):
    """A forward-looking depth camera: one image per entry of `captures`."""

    captures: tuple[Length, ...] = Field(min_length=1, description="travelled distances at which it looks")
    width: int = Field(160, ge=8, le=2048)
    height: int = Field(120, ge=8, le=2048)
    focal_px: float = Field(100.0, gt=0.0)
    position: Triple = (0.0, 0.0, 0.0)
    noise: NonNegativeLength = 0.001
    noise_quadratic: NonNegative = Field(0.0, description="sigma per square metre of depth [1/m]")
    dropout: Share = 0.0
    range_max: PositiveLength = 3.0


class Inertial(Part):
    """The inertial unit."""

    rate: float = Field(100.0, gt=0.0, le=2000.0, description="Hz")
    output: Literal["rates", "attitude"] = "rates"
    position: Triple = (0.0, 0.0, 0.0)
    gyro_bias_deg_h: Triple = (0.0, 0.0, 0.0)
    gyro_noise_deg_sqrt_h: NonNegative = Field(0.0, description="angle random walk")
    gyro_walk_deg_h_sqrt_h: NonNegative = Field(0.0, description="random walk of the bias")
    gyro_scale: Annotated[float, Field(ge=-0.2, le=0.2)] = 0.0
    accel_bias: Triple = Field((0.0, 0.0, 0.0), description="m/s2")
    accel_noise: NonNegative = Field(0.0, description="m/s2 per square root of Hz")
    accel_walk: NonNegative = Field(0.0, description="random walk of the bias, m/s2 per square root of s")
    attitude_noise_deg: NonNegative = Field(0.0, description="output = attitude: one-sigma of each angle")
    clock_offset: Number = Field(0.0, description="what its clock shows too much [s]")
    gap: tuple[tuple[Number, Number], ...] = Field((), description="times without samples [s]")


class Slip(Part):
    """Wheels that turn in place: the odometer counts `extra` more within `length`; negative = wheels that skid."""

    chainage: Length
    length: PositiveLength = 0.1
    extra: Length


class Odometer(Part):
    """The odometer or cable counter."""

    scale_error: Annotated[float, Field(ge=-0.2, le=0.2)] = 0.0
    noise: Share = Field(0.0, description="random walk [m per square root of m]")
    slip: tuple[Slip, ...] = ()


class Ties(Part):
    """Known points of the pipe's axis."""

    chainages: tuple[Length, ...] = Field(min_length=1)
    sigma: PositiveLength = 0.01
