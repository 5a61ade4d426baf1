"""Archives in and out: documents, JSON lines, CSV, Parquet, STAC.

- `entry_document`: an entry as a JSON document of its own, and back
- `flat_rows`: an entry as rows of numbers, for tables
- `jsonl`, `csv_tables`, `parquet`, `stac`: what is written in each format, and read again
- `documents`: what measuring commands print with ``--json``, read as entries
- `files`: files that are whole or not there
- `exporting`, `importing`: which format a file has, and what becomes of it
"""
