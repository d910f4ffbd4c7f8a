"""Controllable elements of the hand, the controller protocol and the ON-OFF law."""
