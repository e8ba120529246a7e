"""The capture thread of one camera: its state and counts, faults of its pictures, and how it opens a lost camera again."""
