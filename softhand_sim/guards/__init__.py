"""Guards: what ends a trial that can't be trusted, with a typed outcome and a file that repeats it.

They look once a control tick (20 ms), never in the engine's step.
"""
