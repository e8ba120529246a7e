"""The one way in for bytes and text from outside: what comes out is a value or a named error."""
