"""Printable PDFs: the board and the shirt's pattern, at true size."""
