"""The paper's constants. [Wang 2011, sections 4 and 5]"""

from dataclasses import dataclass, field, replace

from mocapd.published.wang2011.chrominance import HistogramParams
from mocapd.published.wang2011.mog_background import MixtureParams
from mocapd.shirt.colour.colour_model import NOISE_SIGMA, SHADING_SIGMA


@dataclass(frozen=True, slots=True)
class Params:
    """Parameters of the paper's variant; those the paper names have its values.

    Without `pose_prior` and `adaptive_white_balance` this is the baseline that the paper compares
    itself with, its Fig. 9 and 10 [akin to Wang & Popovic 2009].
    """

    pose_prior: bool = True  # step 3
    adaptive_white_balance: bool = True  # step 5 and the reference illuminations of step 1

    background: MixtureParams = field(default_factory=MixtureParams)
    histogram: HistogramParams = field(default_factory=HistogramParams)
    min_foreground: float = 0.004  # share of the frame; with less the background hint is not used
    crop: float = 4.5  # side of the region looked at, in windows s of the histogram search
    stride_px: int = 2  # every second pixel each way is classified

    # 0: the paper's colour model. Cloth in real folds and lamps spreads wider than five even images
    # show (shirt/colour/colour_model.py); `tolerating` has both, and thresholds that let in as much background
    shading_sigma: float = 0.0
    noise_sigma: float = 0.0
    threshold: float = 3.0  # T of step 1 [standard deviations]
    poor_classification: float = 0.4  # under this share of foreground the references are tried
    new_illumination: float = 0.5  # Frobenius distance at which a W joins the references
    neighbours: int = 10
    prior_weight: float = 6.0  # C = prior_weight / s
    prior_threshold: float = 5.0  # T of step 3

    iterations: int = 4  # of the inverse kinematics
    min_patch_samples: int = 12  # a smaller patch has no centroid

    # acceptance of a pose, which the paper leaves open
    min_samples: int = 150  # coloured samples of a camera
    max_distance_px2: float = 30.0  # of the nearest id map
    min_agreement: float = 0.35  # share of rendered samples that are classified alike


def paper_params(baseline: bool = False) -> Params:
    """The paper's method or its baseline."""
    return Params(pose_prior=not baseline, adaptive_white_balance=not baseline)


def tolerating(params: Params) -> Params:
    """The same with wider colours and thresholds to match: finds half as many shirt pixels again."""
    return replace(
        params,
        shading_sigma=SHADING_SIGMA,
        noise_sigma=NOISE_SIGMA,
        threshold=1.7,
        prior_threshold=2.8,
    )
