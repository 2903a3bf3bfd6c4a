import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.robots.mujoco.sound import Knock, Substance, modes, ring

STEEL = Substance(7850.0, 2.0e11, 0.29, 5.0, 3e-8)
RATE_HZ = 44100.0


@given(st.floats(0.05, 0.4), st.floats(0.05, 0.4), st.floats(0.5e-3, 8e-3), st.floats(1e9, 3e11))
def test_frequencies_are_those_of_a_supported_plate(length: float, height: float, thick: float, young: float) -> None:
    """The lowest frequency is pi / 2 sqrt(D / (rho h)) (1 / a^2 + 1 / b^2) with D = E h^3 / (12 (1 - nu^2))."""
    substance = Substance(2500.0, young, 0.25, 1.0, 1e-8)
    rigidity = young * thick**3 / (12 * (1 - 0.25**2))
    lowest = np.pi / 2 * np.sqrt(rigidity / (2500.0 * thick)) * (1 / length**2 + 1 / height**2)
    found = modes(substance, (1e3 * length, 10.0, 1e3 * height), 1e3 * thick)
    if lowest >= 60:
        assert found[0, 0] == pytest.approx(lowest, rel=1e-9)
    assert np.all(np.diff(found[:, 0]) >= 0)


def test_a_mode_falls_by_60_db_in_its_time() -> None:
    """The amplitude of a mode alone falls by a factor of 1000 in 2 x 6.908 / (alpha + beta w^2)."""
    table = modes(STEEL, (200.0, 10.0, 100.0), 2.0)[:1]
    frequency = table[0, 0]
    decay_s = 2 * np.log(1000) / (5.0 + 3e-8 * (2 * np.pi * frequency) ** 2)
    sound = ring(table, 1e-4, Knock(1.0), RATE_HZ, 1.2 * decay_s)
    spot, around = int(decay_s * RATE_HZ), int(2 * RATE_HZ / frequency)
    first, later = (np.abs(sound[at : at + around]).max() for at in (0, spot))
    assert later / first == pytest.approx(1e-3, rel=0.03)


def test_soft_touches_sound_dull() -> None:
    """A longer touch leaves less of what is high."""
    table = modes(STEEL, (200.0, 10.0, 100.0), 2.0)

    def centre_hz(contact_s: float) -> float:
        power = np.abs(np.fft.rfft(ring(table, contact_s, Knock(1.0), RATE_HZ, 0.5))) ** 2
        return float(power @ np.fft.rfftfreq(int(0.5 * RATE_HZ), 1 / RATE_HZ) / power.sum())

    assert centre_hz(5e-5) > 1.5 * centre_hz(1e-3)


def test_loudness_is_in_proportion_to_the_knock() -> None:
    """Twice the impulse is twice the sound."""
    table = modes(STEEL, (200.0, 10.0, 100.0), 2.0)
    once, twice = (ring(table, 1e-4, Knock(impulse), RATE_HZ, 0.1) for impulse in (1.0, 2.0))
    np.testing.assert_allclose(twice, 2 * once)
    assert np.abs(once).max() > 0


def test_a_support_damps() -> None:
    """What stands on something rings shorter, at the same frequencies."""
    free, standing = (modes(STEEL, (200.0, 10.0, 100.0), 2.0, support) for support in (0.0, 12.0))
    np.testing.assert_array_equal(free[:, 0], standing[:, 0])
    np.testing.assert_allclose(standing[:, 1] - free[:, 1], 6.0)
