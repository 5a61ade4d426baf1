"""From a measured MTF to a sharper image, and what it costs."""
