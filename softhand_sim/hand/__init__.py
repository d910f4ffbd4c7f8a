"""The MuJoCo hand: anatomy, one finger, the hand on its wrist, the scene around it."""
