"""Tapes: the same outcomes for every method, whatever else is drawn."""

import pytest

from palpate import EvidenceError, Network, load_network
from palpate.experiments.tapes import TapeRobot, draw_tapes, stable_int
from palpate.robots.contract import RobotContract


class TestTapeRobot(RobotContract):
    """A robot that plays a tape keeps the contract of robots."""

    network = load_network("household-filled")

    def make_robot(self):
        (tape,) = draw_tapes(self.network, ["ceramic_mug"], 1, seed=0)
        return TapeRobot(tape)


def test_a_tape_does_not_depend_on_what_else_is_drawn(household: Network) -> None:
    """The tape of an object and repetition is the same alone and among others."""
    alone = draw_tapes(household, ["wineglass"], 1, seed=3)
    among = draw_tapes(household, ["banana", "wineglass"], 4, seed=3)
    assert alone[0] == next(tape for tape in among if tape.object == "wineglass")


def test_tapes_differ_between_seeds_and_repetitions(household: Network) -> None:
    """Repetitions and seeds have outcomes of their own."""
    tapes = [*draw_tapes(household, ["banana"], 2, seed=0), *draw_tapes(household, ["banana"], 2, seed=1)]
    assert len({str(tape.outcomes["weighing"]) for tape in tapes}) == 4


def test_stand_ins_are_simulated_and_not_scored(household: Network) -> None:
    """What is not known of an object is on the tape, and not in its truth."""
    (tape,) = draw_tapes(household, ["banana"], 1, seed=0)
    assert household.objects["banana"].truth["material"].status == "unknown"
    assert "material" not in tape.truth
    assert "mat-sound" in tape.outcomes


def test_trick_objects_are_marked(household: Network) -> None:
    """An object that looks like another one is a trick on its tape."""
    tricks = {tape.object for tape in draw_tapes(household, list(household.objects), 1, seed=0) if tape.trick}
    assert tricks == {"banana_ycb", "stiff_yellow_sponge", "wineglass_ycb"}


def test_an_action_that_is_not_on_the_tape_is_an_error(household: Network) -> None:
    """The error names the actions that are."""
    (tape,) = draw_tapes(household, ["banana"], 1, seed=0)
    with pytest.raises(EvidenceError, match=r"unknown action 'lick'.*cat-vision"):
        TapeRobot(tape).perform("lick")


def test_names_have_the_same_number_in_every_process() -> None:
    """CRC-32 of the name, and not Python's own hash, which differs between processes."""
    assert stable_int("123456789") == 0xCBF43926
