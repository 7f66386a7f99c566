"""The camera that a scenario describes: its lens, lamps, picture and laser."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .quantities import (
    Length,
    NonNegative,
    Part,
    PositiveLength,
    Share,
    Small,
    Triple,
)

Angle = Annotated[float, Field(ge=-180.0, le=180.0)]
Pixels = Annotated[float, Field(ge=0.0, le=50.0)]


class Lens(Part):
    """The lens: one of five models r = k g(zenith), or OpenCV's polynomial fisheye."""

    model: Literal["equidistant", "sine", "equisolid", "perspective", "stereographic", "polynomial"] = "equidistant"
    field_of_view_deg: float = Field(
        110.0, gt=0.0, lt=360.0, description="full angle across the picture's width; sets the lens's scale k"
    )
    k_px: float | None = Field(
        None, gt=0.0, allow_inf_nan=False, description="its scale, in place of field_of_view_deg"
    )
    coefficients: tuple[Annotated[float, Field(allow_inf_nan=False)], ...] = Field(
        (), max_length=4, description="polynomial: k1 to k4 of OpenCV's fisheye"
    )
    view_angle_deg: float | None = Field(
        None, gt=0.0, le=360.0, description="full angle that the housing lets through; black beyond"
    )
    centre_px: tuple[float, float] | None = Field(
        None, description="column and row of the principal point; default: the picture's middle"
    )


class Lamp(Part):
    """One lamp on the camera."""

    position: Triple = Field((0.0, 0.0, 0.0), description="from the camera, in its axes: ahead, up, right")
    power: Annotated[float, Field(ge=0.0, le=1000.0)] = Field(
        1.0, description="share of the light, against the other lamps"
    )
    half_angle_deg: float = Field(60.0, ge=1.0, le=90.0, description="off the optical axis at which half is left")
    pitch_deg: Angle = Field(0.0, description="of its beam, up from the camera's")
    yaw_deg: Angle = Field(0.0, description="of its beam, right from the camera's")


class Laser(Part):
    """A laser plane across the robot's axis, which draws a ring on the wall."""

    ahead: PositiveLength = Field(0.3, description="of the camera, along the robot's axis")
    offset_y: Length = Field(0.0, description="of its source above the camera, in robot axes")
    offset_z: Length = Field(0.0, description="of its source to the right of the camera, in robot axes")
    pitch_deg: Small = Field(0.0, description="of its plane's axis, against the robot's")
    yaw_deg: Small = 0.0
    line_width: PositiveLength = Field(0.002, description="full width of the line on the wall at half its brightness")
    power: NonNegative = Field(3.0, description="brightness of the line; 1 is a wall fully lit by the lamps")
    colour: tuple[Share, Share, Share] = (1.0, 0.15, 0.1)
    speckle: NonNegative = Field(0.3, description="relative one-sigma of the line's grain")
    wet: Share = Field(0.0, description="share of the wall that is wet: glare around the line, and glints")
    ghost: Share = Field(0.0, description="brightness of a second ring by inner reflection, against the first")
    ghost_ahead: Length = Field(0.05, description="how far ahead of the plane the second ring lies")


class Dust(Part):
    """What floats in the air."""

    haze: NonNegative = Field(0.0, description="light lost per metre of way [1/m], part of it thrown back")
    specks: Annotated[float, Field(ge=0.0, le=10000.0)] = Field(
        0.0, description="bright motes out of focus, per picture on average"
    )


class Camera(Part):
    """A camera that looks ahead."""

    spacing: PositiveLength = Field(0.1, description="of odometer readings between frames")
    width: int = Field(640, ge=16, le=4096)
    height: int = Field(480, ge=16, le=4096)
    name: str = Field("camera", min_length=1, description="of the lens, in /frames and in the survey's lens tables")
    lens: Lens = Lens()
    position: Triple = Field((0.0, 0.0, 0.0), description="in robot axes: ahead, up, right of the robot's middle")
    pitch_deg: Angle = Field(0.0, description="its tilt on the robot: up")
    yaw_deg: Angle = Field(0.0, description="right")
    roll_deg: Angle = Field(0.0, description="from its right towards its up")
    error_position: Triple = Field((0.0, 0.0, 0.0), description="how far it truly sits from there")
    error_pitch_deg: Small = Field(0.0, description="how far it truly looks from there")
    error_yaw_deg: Small = 0.0
    error_roll_deg: Small = 0.0
    lamp: tuple[Lamp, ...] = Field(
        (Lamp(position=(0.0, 0.0, -0.035)), Lamp(position=(0.0, 0.0, 0.035))), description="none = only its laser"
    )
    laser: Laser | None = None
    dust: Dust = Dust()
    ambient: NonNegative = Field(0.03, description="light from all round, against that of the lamps")
    sight: PositiveLength = Field(6.0, description="farther than that everything is black")
    exposure: float = Field(
        1.0, gt=0.0, le=1000.0, description="1 = a white wall at 45 degrees is just not overexposed"
    )
    gamma: float = Field(2.2, ge=0.5, le=4.0)
    vignetting: Share = Field(0.3, description="share of light lost in the picture's corners")
    blur_px: Pixels = Field(0.7, description="one-sigma of the lens's blur")
    noise: Share = Field(0.008, description="one-sigma of a black pixel, of full scale")
    shot_noise: Share = Field(0.01, description="more of it, growing as the root of the light, at full scale")
    format: Literal["jpg", "png"] = "jpg"
    quality: int = Field(92, ge=1, le=100, description="of JPEG")
