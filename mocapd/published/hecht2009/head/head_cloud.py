"""The head's particle filter: predict, sample at the measurements, weight and resample."""

from dataclasses import dataclass

import numpy as np

from mocapd.published.hecht2009.resampling import resample
from mocapd.types import Floats

_SD_FLOOR_M = 0.004  # of the cloud along any direction, so that its density can be written down

_FAR_SDS = 4.0
_PARTICLES = 100  # [Hecht 2009, section IV.A]
_MEASURED_SHARE = 0.3  # of the particles, drawn where the measurements are
# spread of a head's acceleration; the hardest in recorded motion is 10 to 20
_PUSH_SD_M_S2 = 8.0
_JITTER_SD_M = 0.006  # over 1/30 s, growing with the square root of time
_WIDE_M = 0.5  # prior spread of a position


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Places (P,3) [m] and velocities (P,3) [m/s] of the head's middle, all of one weight."""

    place_m: Floats
    velocity_m_s: Floats


@dataclass(frozen=True, slots=True, eq=False)
class HeadObservations:
    """Gaussians in space: means (O,3) [m] and inverse covariances (O,3,3) [1/m^2], which may leave directions open."""

    means_m: Floats
    information: Floats


def along_ray(from_m: Floats, ray: Floats, sigma_across_m: float) -> tuple[Floats, Floats]:
    """A measurement on the ray from a point (3,) along a unit vector (3,)."""
    return from_m, (np.eye(3) - np.outer(ray, ray)) / sigma_across_m**2


def at_distance(
    from_m: Floats, ray: Floats, distance_m: float, sigma_m: float
) -> tuple[Floats, Floats]:
    """A measurement at this distance from a point (3,), along a unit vector (3,)."""
    return from_m + distance_m * ray, np.outer(ray, ray) / sigma_m**2


def observations(parts: list[tuple[Floats, Floats]]) -> HeadObservations:
    """The observations of `along_ray` and `at_distance` combined."""
    if not parts:
        return HeadObservations(np.zeros((0, 3)), np.zeros((0, 3, 3)))
    means, information = (np.ascontiguousarray(np.stack(a)) for a in zip(*parts, strict=True))
    return HeadObservations(means, information)


def cloud_at(
    middle_m: Floats, covariance_m2: Floats, rng: np.random.Generator, particles: int = _PARTICLES
) -> Cloud:
    """A cloud for a head at rest near a position."""
    place = rng.multivariate_normal(middle_m, covariance_m2, particles, method="eigh")
    return Cloud(place, rng.normal(0.0, 0.3, (particles, 3)))


def predict(cloud: Cloud, dt_s: float, rng: np.random.Generator) -> Cloud:
    """The cloud after dt: constant velocity and noise."""
    push = rng.normal(0.0, _PUSH_SD_M_S2, cloud.place_m.shape)
    jitter = rng.normal(0.0, _JITTER_SD_M * np.sqrt(30.0 * dt_s), cloud.place_m.shape)
    place = cloud.place_m + cloud.velocity_m_s * dt_s + 0.5 * push * dt_s**2 + jitter
    return Cloud(place, cloud.velocity_m_s + push * dt_s)


def moments(place_m: Floats, weight: Floats | None = None) -> tuple[Floats, Floats]:
    """Mean (3,) and covariance (3,3) of places (P,3)."""
    w = np.full(len(place_m), 1.0 / len(place_m)) if weight is None else weight
    mean = w @ place_m
    away = place_m - mean
    return mean, (away * w[:, None]).T @ away + _SD_FLOOR_M**2 * np.eye(3)


def fuse(
    mean_m: Floats, covariance_m2: Floats, measured: HeadObservations
) -> tuple[Floats, Floats]:
    """Mean and covariance with all measurements taken as Gaussian."""
    prior = np.linalg.inv(covariance_m2)
    information = prior + measured.information.sum(axis=0)
    right = prior @ mean_m + np.einsum("oij,oj->i", measured.information, measured.means_m)
    covariance = np.linalg.inv(information)
    return covariance @ right, covariance


def is_far(cloud: Cloud, measured: HeadObservations) -> bool:
    """True if a measurement is too far from all particles for the same head, beyond chance."""
    mean, covariance = moments(cloud.place_m)
    for at, information in zip(measured.means_m, measured.information, strict=True):
        # along each measured axis, with the cloud's own spread added
        values, axes = np.linalg.eigh(information)
        for value, axis in zip(values, axes.T, strict=True):
            if value > 1e-6:
                spread = np.sqrt(1.0 / value + axis @ covariance @ axis)
                if abs(axis @ (mean - at)) > _FAR_SDS * spread:
                    return True
    return False


def cloud_about(measured: HeadObservations, before: Cloud, rng: np.random.Generator) -> Cloud:
    """Particles sampled at the measurements, with unmeasured directions unchanged and a wide velocity."""
    mean, _ = moments(before.place_m)
    middle, covariance = fuse(mean, _WIDE_M**2 * np.eye(3), measured)
    return cloud_at(middle, covariance, rng)


def propose(
    cloud: Cloud, measured: HeadObservations, rng: np.random.Generator
) -> tuple[Cloud, Floats]:
    """Draws some of the particles at the measurements; with the logarithm (P,) of the importance weights.

    Importance sampling from a mixture (Isard and Blake, ICondensation, ECCV 1998), the cloud's own density taken as
    Gaussian. Their velocities follow from the cloud's correlation of place and velocity.
    """
    n = round(_MEASURED_SHARE * len(cloud.place_m)) if len(measured.means_m) else 0
    if n == 0:
        return cloud, np.zeros(len(cloud.place_m))
    mean, covariance = moments(cloud.place_m)
    fused_mean, fused = fuse(mean, covariance, measured)
    place, velocity = cloud.place_m.copy(), cloud.velocity_m_s.copy()
    place[:n] = rng.multivariate_normal(fused_mean, fused, n, method="eigh")
    away = cloud.place_m - mean
    spread = cloud.velocity_m_s - cloud.velocity_m_s.mean(axis=0)
    slope = np.linalg.solve(covariance, away.T @ spread / len(away))
    velocity[:n] += (place[:n] - cloud.place_m[:n]) @ slope
    prior = _log_density(place, mean, covariance)
    at_measurements = _log_density(place, fused_mean, fused)
    share = n / len(place)
    mixture = np.logaddexp(np.log1p(-share) + prior, np.log(share) + at_measurements)
    return Cloud(place, velocity), prior - mixture


def _log_density(place_m: Floats, mean_m: Floats, covariance_m2: Floats) -> Floats:
    """Log density of a Gaussian, without its constant."""
    away = place_m - mean_m
    far2 = np.einsum("pi,ij,pj->p", away, np.linalg.inv(covariance_m2), away)
    return np.asarray(-0.5 * far2 - 0.5 * np.log(np.linalg.det(covariance_m2)))


def resampled(cloud: Cloud, weight: Floats, rng: np.random.Generator) -> Cloud:
    """The same number of particles with equal weights."""
    chosen = resample(weight, rng.random(), len(weight))
    return Cloud(cloud.place_m[chosen], cloud.velocity_m_s[chosen])
