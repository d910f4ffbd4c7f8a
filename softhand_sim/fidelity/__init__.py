"""Accuracy against cost: closed forms, what a setting costs and misses, and the choice by tolerance."""
