"""The shirt's colours in the light of the place: proposes and checks strokes, and solves the light."""
