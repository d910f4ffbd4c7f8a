"""Learned policies: a small network that reaches and closes in the place of a grasp's own approach."""
