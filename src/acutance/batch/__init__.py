"""Many images times many targets, measured by one command and kept in an archive."""
