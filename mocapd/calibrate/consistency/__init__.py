"""Whether what is given of cameras (places, lenses, times) agrees with what their pictures show."""
