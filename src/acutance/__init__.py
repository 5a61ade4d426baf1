"""acutance: how sharp an Earth-observation satellite really sees."""

__version__ = "0.1.0"
