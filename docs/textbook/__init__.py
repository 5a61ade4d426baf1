"""What the textbook shows of the code: figures, tables and help texts, made at every build."""
