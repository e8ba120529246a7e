"""Sessions replayed in the browser."""
