"""The published tracker without a shirt: Hecht, Azad and Dillmann, ICRA 2009."""
