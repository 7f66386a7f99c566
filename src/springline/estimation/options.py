"""Settings of the joint estimator, every one with its default."""

from __future__ import annotations

from dataclasses import dataclass, fields

from ..errors import ParameterError


@dataclass(frozen=True)
class JointOptions:
    """Knots, noise laws and priors; one-sigma unless said otherwise.

    Attributes:
        knot_step: Odometer reading between knots [m].
        gyro_noise: Angle random walk of the gyro [rad per square root of s].
        gyro_bias: Prior of the gyro's bias [rad/s].
        accel_noise: Of the specific force averaged over one second [m/s2], with the shaking of the robot; a start, then
            taken from the data.
        accel_bias: Prior of the accelerometer's bias [m/s2]; along the pipe and across it nothing else tells it.
        scale: Prior of the odometer's scale.
        slip: Prior of the travel direction against the forward axis [rad].
        lever: Prior of the place, along the robot and below it, that moves straight ahead [m].
        axles: Prior of the axles' area [m2].
        clock: Prior of the inertial clock's offset [s].
        along: Random walk of the odometer [m per square root of m].
        across: Random walk of sideways creep [m per square root of m]; a start, then taken from the data.
        kink: Random walk of the pipe's direction [rad per square root of m]; a start, then taken from the data.
        trend: Random walk of the section's change [m per m, per square root of m]; a start, then taken from the data.
        wander: Random walk of the section's values [m per square root of m].
        turning: No inertial log: random walk of the robot's attitude [rad per square root of m]; a start.
        unsure: Factor, one-sigma, to which the starts of what is taken from the data are known beforehand.
        tails: Degrees of freedom of Student's t by which outliers, slips, knocks and kinks are let through.
        kink_tails: The same for the pipe's direction: between joints it keeps it, at joints and in bends it does not.
        across_tails: The same for sideways creep: wheels in a bend are pushed aside.
        iterations: Most Gauss-Newton steps.
        tolerance: Step, in one-sigma and root mean square over the knots, below which the estimate stands.
    """

    knot_step: float = 0.05
    gyro_noise: float = 8.7e-5
    gyro_bias: float = 5e-4
    accel_noise: float = 0.01
    accel_bias: float = 0.015
    scale: float = 0.005
    slip: float = 0.02
    lever: float = 0.3
    axles: float = 0.1
    clock: float = 0.05
    along: float = 2e-3
    across: float = 1e-4
    kink: float = 5e-4
    trend: float = 5e-4
    wander: float = 1e-5
    turning: float = 0.1
    unsure: float = 3.0
    tails: float = 4.0
    kink_tails: float = 1.0
    across_tails: float = 4.0
    iterations: int = 15
    tolerance: float = 0.1

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not value > 0:
                raise ParameterError(f"{field.name} is {value}", expected="a number above zero")
        if not self.unsure > 1.0:
            raise ParameterError(f"unsure is {self.unsure}", expected="a factor above one")
