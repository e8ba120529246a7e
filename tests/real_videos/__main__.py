"""Real videos of others, measured and looked at: `python -m tests.real_videos ../shared/realvideo docs` writes the page."""

import sys
from pathlib import Path

import numpy as np

from mocapd.evaluate.tables import number, table
from mocapd.published.hecht2009.face.lbp_cascade import frontal_faces
from tests.real_videos.beam import INSIDE, NEAR_PX, SCALE, STATURE_M, BeamWalk, beam_walk
from tests.real_videos.contact_sheet import write_sheet
from tests.real_videos.signing import SigningClip, signing_clip

FACES, BEAM = "images/real-faces.jpg", "images/real-beam.jpg"

_PAGE = """\
# Real videos

Written by this command, which makes everything below anew; do not edit by hand:

```sh
python -m tests.real_videos {videos} {docs}
```

Everything else is measured on simulated pictures, whose truth is known. These videos were recorded by others, and their truth
is not known: it can only be said whether what is found lies where somebody is.

## A face, and the head that has it
Ten clips of people who sign before one webcam (Intel, `intel_asl`, [CC BY 4.0](https://creativecommons.org/licenses/by/4.0/);
pictures made smaller, boxes and outlines drawn into them). The head's tracker of `hecht2009` begins anew with each clip.
*Face*: frames in which the cascade sees the face where the head is; *head*: frames in which a head is known, with its face or
by its colours and outline alone. Every frame of the clips shows the face, in some a hand hides its chin.

{faces_table}

![Every clip at four instants: the face in green, the head in yellow]({faces})

Limbs are not told of them: that needs two cameras.

## A man on a beam
Four cameras around a man who balances on a beam (Pose2Sim, `SinglePerson`, BSD-3-Clause, copyright 2022 perfanalytics;
cameras calibrated by them). `markerless` sees the two before him, 2.9 m apart; he never leaves their pictures, so the room is
learned from the whole clip (`mocapd track --room whole`). His height, {stature_m:.2f} m, was measured in the pictures.

| | cameras that `markerless` sees | those behind him, which it never sees |
|---|---:|---:|
| frames with the skeleton inside of him, of all {frames} | {share:.0f} % | {share_elsewhere:.0f} % |
| of the frames in which he is told: points along the bones inside of him, mean | {points:.1f} % | {points_elsewhere:.1f} % |

A skeleton is inside when {inside:.0f} % of five points on each bone lie on what stands before the room as learned of each
camera's clip (`mocapd/vision/clip_background.py`), or no more than {near} px beside it, in both cameras together. Where he
hides the room all the time it cannot be told from him, and counts as he. He is told from frame {first} of {frames} on: two
looks 0.2 s apart must agree, and then some frames in a row.

What the pictures show besides: legs, trunk, head and left arm follow him; his raised right arm is told before his chest,
where it lies inside of him all the same.

![Both cameras at ten instants: his right in red, his left in green]({beam})
"""


def page(clips: list[SigningClip], walk: BeamWalk, videos: Path, docs: Path) -> str:
    """The page as Markdown."""
    rows = [_row(clip.name, [clip]) for clip in clips]
    told = list(walk.inside)
    return _PAGE.format(
        videos=videos,
        docs=docs,
        faces_table=table(["clip", "frames", "face [%]", "head [%]"], [*rows, _row("all", clips)]),
        faces=FACES,
        beam=BEAM,
        stature_m=STATURE_M,
        frames=walk.frames,
        share=100.0 * walk.share(walk.inside),
        share_elsewhere=100.0 * walk.share(walk.elsewhere),
        points=100.0 * np.mean(list(walk.inside.values())),
        points_elsewhere=100.0 * np.mean(list(walk.elsewhere.values())),
        inside=100.0 * INSIDE,
        near=NEAR_PX * SCALE,
        first=told[0],
    )


def _row(name: str, clips: list[SigningClip]) -> list[str]:
    faces = [one for clip in clips for one in clip.faces]
    heads = [one for clip in clips for one in clip.heads]
    shares = (100.0 * float(np.mean(of)) for of in (faces, heads))
    return [name, str(len(faces)), *(number(one, 1) for one in shares)]


def main(videos: Path, docs: Path) -> None:
    """Measure, and write the page with its pictures."""
    cascade = frontal_faces()
    clips = [signing_clip(one, cascade, 4) for one in sorted(videos.glob("intel_asl/*.mkv"))]
    walk = beam_walk(videos / "pose2sim_SinglePerson", 10)
    tiles = [[*a.tiles, *b.tiles] for a, b in zip(clips[::2], clips[1::2], strict=True)]
    write_sheet(docs / FACES, tiles)
    write_sheet(docs / BEAM, walk.tiles)
    (docs / "real-videos.md").write_text(page(clips, walk, videos, docs), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
