"""Measurements kept over years, and the questions that are asked of them.

Sees records only, never pixels.
"""
