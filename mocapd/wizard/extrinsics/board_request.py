"""What the step asks for while the board is held where cameras see it together."""


def board_request(two_sided: bool, lonely: str | None) -> str:
    """lonely: the name of a camera that shares too few sightings with the others."""
    if lonely is not None:
        sides = ", from either side" if two_sided else ""
        return f"Hold the board where {lonely} and another camera see it{sides}; keep it still for a moment."
    if two_sided:
        return (
            "Hold the board where cameras see it together, from either side, here and there, and turn it over now and "
            "then; keep it still each time."
        )
    return (
        "Hold the board where the cameras see it together, here and there; keep it still each time."
    )
