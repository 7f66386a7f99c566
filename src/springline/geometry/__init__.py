"""Pure mathematics of pipes: arrays in, arrays out, SI and radians, NaN = no return.

Each subpackage follows a chapter of the dissertation: `sections` (3), `liners` (7), `fitting` (2.9.1), `robot`
(4.1 and 5), `bends` (4.2), `lenses` (2.7), `camera` (6.3), `openings` (6.2), `contours` (2.9.2 and 6.6).
"""
