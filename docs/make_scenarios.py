"""Write docs/scenarios.md from the models in `springline.simulate`: run `python docs/make_scenarios.py`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from springline.simulate import Scenario, scenarios

_RANGES = {"exclusiveMinimum": "> {}", "minimum": ">= {}", "exclusiveMaximum": "< {}", "maximum": "<= {}"}

INTRODUCTION = """# Scenarios of the simulator

Made by `docs/make_scenarios.py` from the models in `springline.simulate`; change it there.

A scenario is one TOML file. Lengths are metres, or text with a unit (`"300mm"`, `"12in"`); angles are degrees and say
so in their key; clocks are hours seen from the pipe's start, chainages run along the pipe's axis from there; the
chainages of robot, odometer and depth camera run from where the robot enters. A value that varies is a number, a list
of points `[[chainage, value], ...]`, a sine `{ mean, amplitude, period, phase_deg }`, or several of them,
`{ mean, waves = [{...}, ...] }`.

The same pipe (`pipe.seed`) can be surveyed many times with other noise (`--seed`).

## Frames of a camera

A scenario with a table `[camera]` has frames. `springline simulate camera-short -o survey.zarr.zip` renders them into
`survey-frames/` beside the file; with `-o folder`, a survey folder, they lie in `folder/frames/` and are listed in
`frames.csv`, and the lens stands in `survey.toml` under `[lens.camera]`. (Pictures are written with Pillow, extra
`depth`.) From Python a frame is rendered when it is asked for, without any file:

```python
from springline.simulate import Footage, simulate

footage = Footage("camera-short", seed=1)  # a ready scenario, a TOML file, or a Scenario
picture = footage.image(12)  # frame 12: uint8 (rows, columns, 3), red green blue
footage.distance[12], footage.time[12]  # what /frames says of it
survey = simulate("camera-short", seed=1)  # the same frames, listed in /frames, with the truth
survey.truth["frame_chainage"][12]  # the camera's true pose, and frame_offset_y, frame_pitch, ...
```

What a detector is scored against stands in the truth too. `footage.outlines(12)` lists every lateral and joint of which
something is seen in frame 12: `kind`, `feature` (its row among `feature_kind`, `feature_chainage`, `feature_bearing`,
`feature_size`, ...), `part` (0 = a lateral's edge, or the rim of a joint that is met first; 1 = the joint's other rim),
`ahead` (chainage from the camera to it [m]), `points` (column and row of 96 places around it) and `seen` (which of them
are in the picture and hidden by nothing). `/truth` holds the same for all frames: outline n is of frame
`outline_frame[n]` and has the points `outline_first[n]` to `outline_first[n] + outline_count[n]` of `outline_column`,
`outline_row`, `outline_seen`. Deposits, cracks and stains, the decoys, are rows of the same feature table;
`hit_kinds` in the truth's attributes names the codes. Far features are in view, but dark: choose by `ahead`.

With `[camera.laser]` a laser plane draws a ring on the wall (scenario `ring-video`); `laser_range` in the truth is the
way from its source to the wall (frame, bearing), in the plane, and `laser_ahead_m` in the lens table is how far ahead
of the camera the plane lies. The line shows the wall's roughness itself; under lamps roughness is drawn as grain. Lamps
cast no shadows: they sit beside the lens, where hardly any would be seen.

A frame of 640x480 takes about 0.3 s of one core, one of 1080p about 1 s; the kernels are compiled once, on the first
frame (half a minute).

Frame k is the same whether the others are made or not. In the lens table, `k_px` is the lens's scale, `centre_px` the
column and row of the principal point with (0, 0) in the middle of the first pixel, rows counting down. The optical axis
lies along the camera's own x (ahead), the picture's right is its z, up its y; `pitch_deg`, `yaw_deg` and `roll_deg`
tilt it on the robot as `conventions` says, and `position_m` is where it sits in robot axes. Errors of the mount are in
the truth alone.

## Ready scenarios

"""


def page() -> str:
    """Return the page as Markdown."""
    schema = Scenario.model_json_schema()
    lines = [f"- `{name}`: {description}" for name, description in scenarios().items()]
    text = INTRODUCTION + "\n".join(lines) + "\n\n## The scenario itself\n\n" + _table(schema, schema)
    for name, part in _parts(schema):
        text += f"\n## `{name}`\n\n{part['description']}\n\n{_table(part, schema)}"
    return text


def _parts(schema: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return every table of a scenario with its model, in the order in which a reader meets them."""
    found: dict[str, dict[str, Any]] = {}

    def walk(prefix: str, model: dict[str, Any]) -> None:
        for key, field in model["properties"].items():
            for name, many in _models(field):
                if name in ("Waves", "Wave", "Points"):
                    continue
                part = schema["$defs"][name]
                kind = part["properties"].get("kind", {}).get("const")
                path = f"[[{prefix}{key}]]" if many else f"[{prefix}{key}]"
                found[path + (f' kind = "{kind}"' if kind else "")] = part
                walk(f"{prefix}{key}.", part)

    walk("", schema)
    return list(found.items())


def _models(field: dict[str, Any], many: bool = False) -> list[tuple[str, bool]]:
    """Return the models that a field may hold, and whether it is a list of them."""
    if "$ref" in field:
        return [(field["$ref"].rsplit("/", 1)[1], many)]
    out = _models(field["items"], True) if isinstance(field.get("items"), dict) else []
    for option in [*field.get("anyOf", []), *field.get("oneOf", [])]:
        out += _models(option, many)
    return out


def _table(model: dict[str, Any], schema: dict[str, Any]) -> str:
    rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
    for key, field in model["properties"].items():
        if "const" in field:
            continue
        default = "required" if key in model.get("required", []) else _default(field)
        rows.append(f"| `{key}` | {_value(field)} | {default} | {field.get('description', '')} |")
    return "\n".join(rows) + "\n"


def _default(field: dict[str, Any]) -> str:
    value = field.get("default")
    return "" if value is None or isinstance(value, dict) or value in ([], "") else f"`{value}`"


def _value(field: dict[str, Any]) -> str:
    models = _models(field)
    if any(name in ("Waves", "Points") for name, _ in models):
        return "varies"
    if models:
        return "tables" if models[0][1] else "table"
    if "enum" in field:
        return ", ".join(f"`{one}`" for one in field["enum"])
    options = [one for one in field.get("anyOf", []) if one.get("type") != "null"]
    if options:
        return " or ".join(_value(one) for one in options)
    limits = " and ".join(text.format(f"{field[name]:g}") for name, text in _RANGES.items() if name in field)
    kind = {"array": "list", "string": "text", "boolean": "true or false"}.get(field.get("type", ""), "number")
    return f"{kind} {limits}".strip()


if __name__ == "__main__":
    Path(__file__).with_name("scenarios.md").write_text(page(), encoding="utf-8")
