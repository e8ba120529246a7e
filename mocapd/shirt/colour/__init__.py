"""The shirt's colours: model, white balance, strokes, and tables for quick classification."""
