"""Simulated surveys with known truth; its own ray-casting geometry, so that no formula is tested with itself."""
