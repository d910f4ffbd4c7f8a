"""Verification problems with closed forms, one a file; ``scripts/verify_fea.py`` writes their table."""
