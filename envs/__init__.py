"""Gymnasium environments of the soft hand."""
