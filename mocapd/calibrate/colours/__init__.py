"""The shirt's colours in the place's own light: strokes proposed, checked and solved."""
