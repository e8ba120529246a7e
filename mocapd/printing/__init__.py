"""What is printed: the board and the shirt's pattern, at true size."""
