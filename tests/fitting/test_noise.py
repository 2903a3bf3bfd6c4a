"""The noise of number sensors: the truth within its error, saturation against a grid, wrong readings."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate, optimize, stats

from palpate.fitting.data import Specimen
from palpate.fitting.noise import HEAVY, NORMAL_OVER_HEAVY, fit_noise
from palpate.fitting.readings import readings_of
from palpate.fitting.shared_offsets import log_likelihood
from palpate.network.admission import AdmittedOutcome
from palpate.network.noises import NormalNoise, StudentTNoise
from palpate.network.sensors import NumberSensor
from palpate.outcomes import Above, Below, Reading

SENSOR = NumberSensor("mass", 6.0)


def measured(sensor: NumberSensor, truths: np.ndarray, repeats: int, seed: int, bias: float = 0.0) -> list[Specimen]:
    """Objects with these true values and readings of them, drawn here and not by the package."""
    rng, found = np.random.default_rng(seed), []
    for place, truth in enumerate(truths.tolist()):
        offset = sensor.offset_sd * rng.normal()
        outcomes: list[AdmittedOutcome] = []
        for _ in range(repeats):
            dof = getattr(sensor.noise, "dof", None)
            z = rng.normal() if dof is None else rng.standard_t(dof)
            y = truth + bias + offset + np.hypot(sensor.sd, sensor.relative_sd * truth) * z
            saturated = Above(sensor.high) if y > sensor.high else Below(sensor.low) if y < sensor.low else None
            outcomes.append(saturated or Reading(float(y)))
        found.append(Specimen(f"{place:04d}", {"mass": truth}, {"weigh": tuple(outcomes)}))
    return found


def test_the_sd_is_the_root_mean_square_error() -> None:
    """Without saturation the most likely SD is that about the true values, by hand."""
    readings = {"weigh": (Reading(11.0), Reading(9.0), Reading(13.0))}
    sensor, part = fit_noise("weigh", SENSOR, [Specimen("a", {"mass": 10.0}, readings)])
    assert sensor.sd == pytest.approx(np.sqrt((1 + 1 + 9) / 3), rel=1e-4)
    assert (part.objects, part.readings, part.saturated, part.left_out) == (1, 3, 0, ())
    assert part.bias is not None
    assert part.bias.value == pytest.approx(1.0, abs=1e-3)
    assert part.bias.sd_without == pytest.approx(np.sqrt(8 / 3), rel=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_the_sd_is_within_its_error(seed: int) -> None:
    """Of 300 readings the log of the SD is within 4.5 / sqrt(600) of the truth, and the bias within 4.5 of its SE."""
    truths = np.random.default_rng(seed).uniform(20, 400, 100)
    sensor, part = fit_noise("weigh", SENSOR, measured(SENSOR, truths, 3, seed))
    assert abs(np.log(sensor.sd / 6)) < 4.5 / np.sqrt(600)
    assert part.bias is not None
    assert part.bias.se == pytest.approx(6 / np.sqrt(300), rel=0.4)
    assert abs(part.bias.value) < 4.5 * part.bias.se


def test_no_sd_of_a_grid_is_more_likely_with_saturation() -> None:
    """The Tobit likelihood, written out with scipy, is nowhere on a grid above that of the estimate."""
    true = replace(SENSOR, sd=10.0, high=95.0, low=5.0)
    specimens = measured(true, np.linspace(0, 130, 60), 2, 1)
    found, part = fit_noise("weigh", replace(true, sd=1.0), specimens)
    assert part.saturated > 20
    rows = [(float(one.truth["mass"]), outcome) for one in specimens for outcome in one.readings["weigh"]]
    exact, above, below = (
        np.array([(x, getattr(outcome, "value", 0.0)) for x, outcome in rows if isinstance(outcome, kind)]).T
        for kind in (Reading, Above, Below)
    )

    def cost(sd: float) -> float:
        total = stats.norm(exact[0], sd).logpdf(exact[1]).sum() + stats.norm(above[0], sd).logsf(95.0).sum()
        return -float(total + stats.norm(below[0], sd).logcdf(5.0).sum())

    grid = np.linspace(5, 20, 151)
    best = min(grid.tolist(), key=cost)
    assert found.sd == pytest.approx(best, abs=0.1)
    assert found.sd == pytest.approx(10, rel=4.5 / np.sqrt(2 * (120 - part.saturated)))


def test_readings_beyond_saturation_are_not_readings_at_the_bound() -> None:
    """Objects that all read as above the limit change nothing: a bound that holds tells of no noise."""
    specimens = measured(SENSOR, np.full(40, 50.0), 1, 3)
    sensor = replace(SENSOR, high=95.0)
    stones = [Specimen(f"stone{place}", {"mass": 500.0}, {"weigh": (Above(95.0),)}) for place in range(40)]
    alone, together = (fit_noise("weigh", sensor, data)[0].sd for data in (specimens, specimens + stones))
    assert together == pytest.approx(alone, rel=1e-4)


def test_a_part_in_proportion_to_the_truth() -> None:
    """SD and relative SD of a sensor that has both come out near the truth; the template need not be near."""
    true = replace(SENSOR, sd=2.0, relative_sd=0.05)
    truths = np.concatenate([np.full(150, 5.0), np.full(150, 500.0)])
    sensor, _ = fit_noise("weigh", replace(SENSOR, sd=20.0, relative_sd=0.5), measured(true, truths, 2, 4))
    assert sensor.sd == pytest.approx(2.0, rel=4.5 / np.sqrt(600))
    assert sensor.relative_sd == pytest.approx(0.05, rel=4.5 / np.sqrt(600))


def test_an_offset_shared_by_the_readings_of_an_object() -> None:
    """Offset and noise are told apart by readings of one object: both within 4.5 standard errors."""
    true = replace(SENSOR, sd=1.0, offset_sd=5.0)
    sensor, part = fit_noise("weigh", replace(true, sd=9.0, offset_sd=1.0), measured(true, np.full(120, 50.0), 4, 5))
    assert sensor.sd == pytest.approx(1.0, rel=4.5 / np.sqrt(2 * 360))
    assert sensor.offset_sd == pytest.approx(5.0, rel=4.5 / np.sqrt(2 * 120))
    assert part.bias is not None
    assert part.bias.se == pytest.approx(5 / np.sqrt(120), rel=0.4)


def test_the_closed_form_with_an_offset_is_that_of_the_sensor() -> None:
    """The likelihood of all objects at once is the sum of the sensor model's own, object by object."""
    sensor = replace(SENSOR, sd=2.0, relative_sd=0.03, offset_sd=4.0)
    specimens = measured(sensor, np.linspace(10, 300, 9), 3, 6)
    readings = readings_of("weigh", sensor, specimens)
    one_by_one = [sensor.log_likelihood(outcomes, np.array([truth]))[0] for truth, outcomes in readings.by_thing()]
    assert len(one_by_one) == 9
    assert log_likelihood(sensor, 0.0, readings) == pytest.approx(sum(one_by_one), rel=1e-12)


@pytest.mark.parametrize("noise", [NormalNoise(), StudentTNoise(4.0)])
def test_bounds_with_an_offset_are_as_likely_as_by_the_sensor(noise: NormalNoise | StudentTNoise) -> None:
    """Objects with and without readings beyond saturation, and a bias, give the sum of the sensor model's own."""
    sensor = replace(SENSOR, sd=2.0, relative_sd=0.03, offset_sd=6.0, high=95.0, low=12.0, bias=1.5, noise=noise)
    readings = readings_of("weigh", sensor, measured(sensor, np.linspace(2, 110, 12), 3, 6, bias=1.5))
    one_by_one = [sensor.log_likelihood(outcomes, np.array([truth]))[0] for truth, outcomes in readings.by_thing()]
    assert {-1.0, 0.0, 1.0} <= set(readings.side.tolist())
    assert log_likelihood(sensor, 1.5, readings) == pytest.approx(sum(one_by_one), rel=1e-6)


@pytest.mark.parametrize("seed", range(2))
def test_a_whole_sensor_is_found(seed: int) -> None:
    """Bias, shared offset, noise and saturation, of which the template knows nothing, are within their errors."""
    true = replace(SENSOR, sd=1.5, offset_sd=4.0, high=95.0)
    specimens = measured(true, np.linspace(10, 110, 150), 4, seed, bias=7.0)
    sensor, part = fit_noise("weigh", replace(SENSOR, sd=20.0), specimens, whole=True)
    assert part.bias is not None
    assert sensor.bias == pytest.approx(7.0, abs=4.5 * 4.1 / np.sqrt(120))
    assert sensor.sd == pytest.approx(1.5, rel=4.5 / np.sqrt(2 * 3 * 110))
    assert sensor.offset_sd == pytest.approx(4.0, rel=4.5 / np.sqrt(2 * 110))
    assert (sensor.high, sensor.low) == (95.0, -np.inf)


def test_without_being_asked_no_bias_and_no_offset_are_fitted() -> None:
    """A sensor that has neither gets neither; one that has a bias gets a new one."""
    specimens = measured(replace(SENSOR, offset_sd=4.0), np.linspace(10, 110, 60), 3, 5, bias=20.0)
    sensor, _ = fit_noise("weigh", SENSOR, specimens)
    assert (sensor.bias, sensor.offset_sd, sensor.high) == (0.0, 0.0, np.inf)
    again, _ = fit_noise("weigh", replace(SENSOR, bias=-3.0), specimens)
    assert again.bias == pytest.approx(20.0, abs=3.0)


def test_a_bias_within_its_error_is_none() -> None:
    """Of readings whose mean is nearly the truth the SD is written, and no bias."""
    errors = {"a": (-3.0, -2.9), "b": (3.1, 3.0), "c": (-3.2, 3.0), "d": (2.9, -2.5)}
    specimens = [
        Specimen(name, {"mass": 10.0}, {"weigh": tuple(Reading(10.0 + error) for error in found)})
        for name, found in errors.items()
    ]
    sensor, part = fit_noise("weigh", SENSOR, specimens, whole=True)
    assert part.bias is not None
    assert 0 < abs(part.bias.value) < part.bias.se
    assert sensor.bias == 0.0


def test_bounds_that_differ_are_no_saturation() -> None:
    """Only where all bounds are one, and no reading is beyond it, does the sensor saturate there."""
    readings = (Reading(11.0), Reading(9.0), Reading(13.0), Reading(60.0))
    for bounds in ((Above(40.0), Above(50.0)), (Above(40.0),)):
        specimens = [Specimen("a", {"mass": 30.0}, {"weigh": (*readings, *bounds)})]
        assert fit_noise("weigh", SENSOR, specimens, whole=True)[0].high == np.inf


def test_a_student_sensor_stays_one() -> None:
    """The scale of heavy-tailed noise is estimated with its own tails, and none of its readings is lost."""
    true = replace(SENSOR, sd=3.0, noise=StudentTNoise(4.0))
    sensor, part = fit_noise("weigh", replace(true, sd=1.0), measured(true, np.full(400, 50.0), 1, 7))
    assert sensor.noise == StudentTNoise(4.0)
    assert len(part.left_out) <= 2
    assert sensor.sd == pytest.approx(3.0, rel=4.5 * np.sqrt((4 + 3) / (2 * 4 * 400)))


def test_a_slip_is_named_and_left_out() -> None:
    """Readings of a tenth of the objects in a wrong unit do not change the SD, and their objects are named."""
    specimens = measured(SENSOR, np.linspace(50, 300, 50), 1, 8)
    slipped = [
        Specimen(one.name, one.truth, {"weigh": (Reading(float(one.truth["mass"]) / 28.35),)})
        if place % 10 == 0
        else one
        for place, one in enumerate(specimens)
    ]
    kept = [one for place, one in enumerate(specimens) if place % 10]
    sensor, part = fit_noise("weigh", SENSOR, slipped)
    assert list(part.left_out) == [one.name for one in specimens[::10]]
    assert sensor.sd == pytest.approx(fit_noise("weigh", SENSOR, kept)[0].sd, rel=1e-3)


def test_a_bias_is_told_and_stays_in_the_sd() -> None:
    """As a sensor model has no bias, its SD holds it; what it would be after calibration is told beside it."""
    sensor, part = fit_noise("weigh", SENSOR, measured(SENSOR, np.linspace(50, 300, 200), 1, 9, bias=8.0))
    assert part.bias is not None
    assert part.bias.value == pytest.approx(8, abs=4.5 * 6 / np.sqrt(200))
    assert sensor.sd == pytest.approx(np.hypot(6, 8), rel=0.15)
    assert part.bias.sd_without == pytest.approx(6, rel=4.5 / np.sqrt(400))


def test_the_constant_of_the_heavy_fit() -> None:
    """The scale of Student's t that is most likely for normal noise of SD 1 is one over the constant."""

    def slope(scale: float) -> float:
        def part(z: float) -> float:
            return (HEAVY + 1) * z * z / (HEAVY * scale**2 + z * z) * float(stats.norm.pdf(z))

        return float(integrate.quad(part, -12, 12)[0] - 1)

    assert 1 / optimize.brentq(slope, 0.3, 2) == pytest.approx(NORMAL_OVER_HEAVY, abs=1e-4)


@pytest.mark.parametrize(
    "readings",
    [(), (Reading(1.0), Reading(2.0)), (Above(1.0),) * 9, (Reading(10.0),) * 5, (*[Reading(10.0)] * 3, Above(5.0))],
    ids=str,
)
def test_too_few_readings_leave_the_template(readings: tuple[AdmittedOutcome, ...]) -> None:
    """Fewer than three readings that are no bounds, or none with an error, are no data."""
    sensor, part = fit_noise("weigh", SENSOR, [Specimen("a", {"mass": 10.0}, {"weigh": readings})])
    assert sensor is SENSOR
    assert part.bias is None


@pytest.mark.parametrize("right", [3, 20, 60])
def test_readings_that_are_rounded(right: int) -> None:
    """Where most readings are right to the last digit, the noise is at least that of rounding, and nothing is lost."""
    errors = [0.0] * right + [1.0, -1.0] * 10
    readings = tuple(Reading(10.0 + error) for error in errors)
    sensor, part = fit_noise("weigh", SENSOR, [Specimen("a", {"mass": 10.0}, {"weigh": readings})])
    assert part.left_out == ()
    assert sensor.sd == pytest.approx(np.sqrt(20 / len(errors)), rel=1e-3)


def test_a_single_error_is_the_noise() -> None:
    """One reading that is off among others that are right to the last digit is not left out: nothing would be left."""
    readings = (*[Reading(10.0)] * 9, Reading(10.5))
    sensor, part = fit_noise("weigh", SENSOR, [Specimen("a", {"mass": 10.0}, {"weigh": readings})])
    assert part.bias is not None
    assert sensor.sd == pytest.approx(np.sqrt(0.25 / 10), rel=1e-3)
