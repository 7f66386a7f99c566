"""Time and memory of the simulator: the ready scenario `weaving` in memory, a quarter and a whole kilometre streamed to
disk (the peak of memory shows whether it grows with the length), and frames of the ready cameras.

Each runs in a process of its own, so that its peak of memory is its own; the first also says what compiling costs.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KILOMETRE = """
name = "A kilometre"
[pipe]
diameter = 0.3
run = [{ kind = "straight", length = 1000.0 }]
joints = { spacing = 2.5, kink_sigma_deg = 0.1 }
water = [{ depth = 0.02 }]
section = [{ shape = "mode", mode = 1, s1 = { mean = 0.975, amplitude = 0.005, period = 9.0 } }]
[robot]
offset_z = { amplitude = 0.025, period = 3.0 }
[rings]
[inertial]
[ties]
chainages = [0.0, 1000.0]
"""


def weaving() -> None:
    """Make 5,067 rings of 360 readings, with inertial unit, odometer and ties."""
    from springline.simulate import simulate

    simulate("reference-ring")
    start = time.perf_counter()
    survey = simulate("weaving")
    _tell(f"weaving, {survey.rings.sizes['ring']} rings of 360 in memory", start)


def quarter() -> None:
    """Stream 24,960 rings of 360 readings to disk."""
    _stream("a quarter of a kilometre, 25,000 rings of 360, streamed", KILOMETRE.replace("1000.0", "250.0"))


def kilometre() -> None:
    """Stream 99,960 rings of 360 readings to disk."""
    _stream("a kilometre, 100,000 rings of 360, streamed", KILOMETRE)


def _stream(what: str, scenario: str) -> None:
    from springline.simulate import parse, simulate_to

    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        simulate_to(Path(folder) / "km.zarr.zip", parse(scenario))
        _tell(what, start)


def frames() -> None:
    """Render frames of the ready cameras in memory."""
    from springline.simulate import Footage

    for name in ("camera-short", "sewer", "ring-video"):
        film = Footage(name)
        film.image(0)
        chosen = range(5, len(film), len(film) // 10)
        start, busy = time.perf_counter(), time.process_time()
        for k in chosen:
            film.image(k)
        one = (time.process_time() - busy) / len(chosen)
        size = f"{film.camera.width}x{film.camera.height}"
        _tell(f"{name}, {len(chosen)} frames of {size}, {one:.2f} s of one core each", start)


def _tell(what: str, start: float) -> None:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{what}: {time.perf_counter() - start:.1f} s, peak {peak:.0f} MiB")


def main() -> None:
    """Run all."""
    for name in ("weaving", "quarter", "kilometre", "frames"):
        subprocess.run([sys.executable, "-c", f"from bench.simulate import {name}; {name}()"], check=True)


if __name__ == "__main__":
    main()
