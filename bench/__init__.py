"""Speed and memory, measured beside published peers on the same data in the same run.

Each module here is one benchmark with a `main()`; `python -m bench NAME...` runs those named, and all by default.
"""
