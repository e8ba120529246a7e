"""The step Colour: freezes pictures, proposes strokes for correction, solves the light."""
