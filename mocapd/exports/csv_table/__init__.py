"""CSV: spreadsheets and scripts."""
