"""Motion files for other programs, one format a folder; tests read the files with other libraries."""
