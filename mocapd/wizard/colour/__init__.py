"""The step Colour: pictures frozen, strokes proposed and mended, the light solved."""
