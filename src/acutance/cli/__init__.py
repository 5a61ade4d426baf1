"""The command line: one module a command, nothing heavy before a command runs."""
