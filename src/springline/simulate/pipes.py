"""The pipe that a scenario describes: its runs, sections, joints and everything on its wall."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from .quantities import (
    Clock,
    Length,
    NonNegative,
    NonNegativeLength,
    Number,
    Part,
    PositiveLength,
    Share,
    Slant,
    Small,
    Triple,
    Varying,
    VaryingLength,
    as_metres,
)


class Straight(Part):
    """A straight run."""

    kind: Literal["straight"]
    length: PositiveLength


class Bend(Part):
    """A circular bend."""

    kind: Literal["bend"]
    radius: PositiveLength = Field(description="radius of the centreline")
    angle_deg: float = Field(gt=0.0, le=180.0)
    towards: Literal["right", "left", "up", "down"] | Clock = Field(
        "right", description="where the centre of curvature lies, as a word or a clock"
    )


class Sag(Part):
    """A sag (or, with a negative depth, a hump) within one straight run, made of three circular arcs."""

    chainage: Length = Field(description="its middle")
    length: PositiveLength
    depth: Length


class Joint(Part):
    """One joint; `offset` displaces the next pipe, `kink` turns it."""

    chainage: Length
    gap: NonNegativeLength = Field(0.006, description="how far the pipe ends stand apart")
    offset_y: Length = 0.0
    offset_z: Length = 0.0
    kink_up_deg: Small = 0.0
    kink_right_deg: Small = 0.0


class Joints(Part):
    """Regular joints; those within a quarter of the spacing of a listed joint give way to it."""

    spacing: PositiveLength
    first: Length | None = Field(None, description="chainage of the first; default: one spacing from the start")
    spacing_sigma: NonNegativeLength = 0.0
    gap: NonNegativeLength = 0.006
    gap_sigma: NonNegativeLength = 0.0
    offset_sigma: NonNegativeLength = 0.0
    kink_sigma_deg: Annotated[float, Field(ge=0.0, le=4.0)] = 0.0


Shape = Literal["circle", "ellipse", "mode", "egg", "horseshoe", "inverted_horseshoe", "loaf", "arch", "box"]


class Stretch(Part):
    """The section along a stretch; parameters may vary along the chainage."""

    start: Length | None = Field(None, description="first chainage; default: the pipe's start")
    end: Length | None = Field(None, description="last chainage; default: the pipe's end")
    shape: Shape
    diameter: VaryingLength | None = Field(None, description="circle; undeformed diameter of mode; default: the pipe's")
    semi_major: VaryingLength | None = Field(None, description="ellipse")
    semi_minor: VaryingLength | None = Field(None, description="ellipse")
    axis_deg: Varying = Field(0.0, description="ellipse: bearing of its major axis")
    mode: int | None = Field(None, ge=1, le=5)
    s1: Varying | None = Field(None, description="mode: severity of the bottom half")
    s02: Varying | None = Field(None, description="mode 4, 5: frozen severity of the top arcs")
    s01: Varying | None = Field(None, description="mode 5: frozen severity of the bottom arcs")
    inverted: bool = Field(False, description="upside down")
    width: PositiveLength | None = None
    height: PositiveLength | None = None
    invert_radius: PositiveLength | None = Field(None, description="egg")
    wall: PositiveLength | None = Field(None, description="loaf and arch: height of the straight wall")
    rise: PositiveLength | None = Field(None, description="arch: height of its crown over the walls")
    fillet: NonNegativeLength = Field(0.0, description="loaf and box: radius of the corners")


class Harmonic(Part):
    """A Fourier term on the polar radius: amplitude cos(order (bearing - phase))."""

    order: int = Field(ge=1, le=24)
    amplitude: VaryingLength
    phase_deg: Number = 0.0


class Lateral(Part):
    """A round connection."""

    chainage: Length = Field(description="where its axis meets the wall")
    clock_h: Clock
    diameter: PositiveLength
    inclination_deg: Slant = Field(0.0, description="tip of its outer end forward along travel")
    protrusion: NonNegativeLength = Field(0.0, description="how far its end stands into the pipe")
    wall_thickness: PositiveLength = 0.005
    length: PositiveLength = Field(1.0, description="how far one sees into it")


class Laterals(Part):
    """Regular laterals of random size and place; they keep off the joints."""

    spacing: PositiveLength
    first: Length | None = Field(None, description="chainage of the first; default: one spacing from the start")
    spacing_sigma: NonNegativeLength = 0.0
    diameters: tuple[PositiveLength, ...] = Field((0.1,), min_length=1, description="of which each has one, by chance")
    clocks_h: tuple[Clock, ...] = Field((3.0, 9.0), min_length=1, description="about which each lies, by chance")
    clock_sigma_h: NonNegative = 0.0
    inclinations_deg: tuple[Slant, ...] = Field((0.0,), min_length=1, description="of which each has one, by chance")
    length: PositiveLength = Field(1.0, description="how far one sees into them")


class Patch(Part):
    """A dent or an attached deposit: deepest in its middle, smooth to its edges."""

    chainage: Length
    clock_h: Clock
    depth: PositiveLength = Field(description="inward")
    length: PositiveLength
    width_deg: float = Field(gt=0.0, le=360.0)


class Level(Part):
    """Water, or a bed of sediment: flat, `depth` above the invert, running out smoothly over `ramp`."""

    start: Length | None = None
    end: Length | None = None
    depth: PositiveLength
    ramp: PositiveLength = 0.5


class Lobe(Part):
    """A liner's lobe; `smooth` draws the host in by depth cos^power, `varying` is the varying-amplitude lobe."""

    start: Length
    end: Length
    clock_h: Clock = 12.0
    depth: PositiveLength
    width_deg: float = Field(gt=0.0, le=240.0)
    form: Literal["smooth", "varying"] = "smooth"
    power: float = Field(2.0, ge=2.0, le=12.0)
    ramp: NonNegativeLength = 0.2


Grain = Annotated[float, Field(ge=1e-5, allow_inf_nan=False), BeforeValidator(as_metres)]


class Relief(Part):
    """Wall roughness: a random relief of stated rms and correlation lengths."""

    rms: NonNegativeLength
    along: Grain = 0.02
    around: Grain = 0.02


class Surface(Part):
    """How the wall looks to a camera."""

    look: Literal["clay", "concrete", "pvc"] | None = Field(
        None, description="default: the one that pipe.material names, else concrete"
    )
    dirt: Share = Field(0.15, description="share of the wall under dirt, most of it near the invert")


class Crack(Part):
    """A crack: a dark line that wanders; a camera alone sees it."""

    chainage: Length = Field(description="of its middle")
    clock_h: Clock
    length: PositiveLength
    direction_deg: float = Field(0.0, ge=-90.0, le=90.0, description="0 = along the pipe, 90 = around it")
    width: PositiveLength = 0.002


class Stain(Part):
    """A dark patch on the wall; a camera alone sees it."""

    chainage: Length = Field(description="of its middle")
    clock_h: Clock
    length: PositiveLength
    width_deg: float = Field(gt=0.0, le=360.0)
    darkness: Share = Field(0.6, description="share of the light that it takes")


class Decoys(Part):
    """What is strewn over the wall at random, each as many per metre on average."""

    cracks: NonNegative = 0.0
    stains: NonNegative = 0.0
    deposits: NonNegative = 0.0


class Pipe(Part):
    """The pipe."""

    diameter: PositiveLength = Field(description="inside diameter of the undeformed round pipe, and nominal")
    wall_thickness: PositiveLength = 0.01
    material: str = ""
    start: Triple = Field((0.0, 0.0, 0.0), description="easting, northing, elevation of the axis at chainage 0")
    heading_deg: Number = 0.0
    gradient: Annotated[float, Field(ge=-1.0, le=1.0)] = Field(0.0, description="rise per metre of run")
    perimeter: Literal["exact", "ramanujan"] = Field("exact", description="rule by which an ellipse keeps its length")
    seed: int = Field(
        0, ge=0, lt=2**32, description="of what is random in the pipe itself: joints, laterals, roughness, looks"
    )
    run: tuple[Annotated[Straight | Bend, Field(discriminator="kind")], ...] = Field(min_length=1)
    sag: tuple[Sag, ...] = ()
    joints: Joints | None = None
    joint: tuple[Joint, ...] = ()
    section: tuple[Stretch, ...] = ()
    harmonic: tuple[Harmonic, ...] = ()
    laterals: Laterals | None = None
    lateral: tuple[Lateral, ...] = ()
    dent: tuple[Patch, ...] = ()
    deposit: tuple[Patch, ...] = ()
    bed: tuple[Level, ...] = ()
    water: tuple[Level, ...] = ()
    lobe: tuple[Lobe, ...] = ()
    roughness: Relief | None = None
    surface: Surface = Surface()
    crack: tuple[Crack, ...] = ()
    stain: tuple[Stain, ...] = ()
    decoys: Decoys = Decoys()
