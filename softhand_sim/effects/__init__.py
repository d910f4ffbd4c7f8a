"""Effects: what a scene pays for only when it calls for it. Each is a value, or None where it is left out."""

from softhand_sim.effects.effects import BENCH, FULL, IDEAL, PRESETS, Effects

__all__ = ["BENCH", "FULL", "IDEAL", "PRESETS", "Effects"]
