"""The body tracker: its state machine, cues, initialisers, hypotheses, cue trust and pose filter."""
