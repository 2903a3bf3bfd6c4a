"""From the bench's signals to outcomes, by the estimators that a real robot's signals go through as well."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import hypot
from pathlib import Path

from palpate.estimators.classifier import Classifier
from palpate.estimators.mel import mel_picture
from palpate.estimators.signals import SignalError
from palpate.estimators.sound import check_decay, features, impact
from palpate.estimators.squeezing import Jaws, squeeze
from palpate.estimators.vision import OnnxClassifier, read_model
from palpate.estimators.weighing import PAYLOAD_KG, Hold, weigh
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.outcomes import Failed, Outcome
from palpate.robots.mujoco import knocking, looking, squeezing, weighing
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.gripper import POSITION_STEP_MM
from palpate.robots.mujoco.reading import SHIPPED, read_roles
from palpate.robots.mujoco.repertoire import repertoire
from palpate.robots.signals import ImageSignals, SoundSignals, SqueezeSignals, WeighSignals

__all__ = ["PICTURES", "SOUNDS", "Ears", "Eyes", "Hand", "MelEars", "estimates"]

_DATA = Path(__file__).parents[2] / "data" / "bench"
SOUNDS = _DATA / "sounds.json"
"""The classifier of knocks that ships."""
PICTURES = (_DATA / "category.toml", _DATA / "material.toml")
"""What is said of the models of images that ship."""


@dataclass(frozen=True)
class Hand:
    """How masses and elasticities are estimated.

    Attributes
    ----------
    grasp_sd_m
        SD of the offset of the grasp [m].
    payload_kg
        The most that the arm can hold [kg].
    limit_kpa
        Readings of elasticity above it are only known to be above [kPa].
    area_sd
        Relative SD of the contact area over the width.
    width_sd_mm
        SD of the rest width as it is told [mm].
    """

    grasp_sd_m: float = 0.006
    payload_kg: float = PAYLOAD_KG
    limit_kpa: float = 95.0
    area_sd: float = 0.0
    width_sd_mm: float = 0.5

    def mass(self, signals: WeighSignals) -> Outcome:
        """The mass that was held, in g."""
        if not signals.holds_something:
            return Failed("nothing is between the fingers: the grasp missed, or the object fell")
        holds = [
            Hold(
                hold.torque_nm,
                hold.empty_torque_nm,
                hold.lever_m,
                hold.time_s,
                hold.empty_time_s,
                hold.lever_per_offset,
                hold.joint,
            )
            for hold in signals.holds
        ]
        return weigh(holds, grasp_sd_m=self.grasp_sd_m, payload_kg=self.payload_kg).outcome

    def elasticity(self, signals: SqueezeSignals) -> Outcome:
        """Young's modulus of what was squeezed, in kPa."""
        jaws = Jaws(
            signals.contact_area_mm2,
            signals.rest_width_mm,
            limit_kpa=self.limit_kpa,
            gap_sd_mm=POSITION_STEP_MM / 12**0.5,
            relative_sd=hypot(self.area_sd, self.width_sd_mm / signals.rest_width_mm),
        )
        return squeeze(signals.gap_mm, signals.force_n, jaws).outcome


@dataclass(frozen=True)
class Ears:
    """How a knock is told: a classifier of its features."""

    classifier: Classifier

    @property
    def labels(self) -> tuple[str, ...]:
        """What it may be."""
        return self.classifier.labels

    def label(self, signals: SoundSignals) -> Outcome:
        """Probabilities of what rang."""
        try:
            return self.classifier.outcome(features(impact(signals.samples, signals.rate_hz)))
        except SignalError as error:
            return Failed(str(error))


@dataclass(frozen=True)
class MelEars:
    """How a knock is told from a picture of its sound: a model of what `mel_picture` draws."""

    model: OnnxClassifier

    @property
    def labels(self) -> tuple[str, ...]:
        """What it may be."""
        return self.model.model.tells

    def label(self, signals: SoundSignals) -> Outcome:
        """Probabilities of what rang."""
        try:
            knock = impact(signals.samples, signals.rate_hz)
            check_decay(knock)
        except SignalError as error:
            return Failed(str(error))
        return self.model.outcome(mel_picture(knock.samples, knock.rate_hz))


@dataclass(frozen=True)
class Eyes:
    """How an image is told: a model for each action that looks."""

    models: Mapping[str, OnnxClassifier] = field(default_factory=dict)

    def of(self, action: str) -> Callable[[ImageSignals], Outcome]:
        """What makes probabilities of an image for an action."""
        model = self.models[action]
        return lambda signals: model.outcome(signals.image)


def estimates(
    network: Network,
    *,
    hand: Hand | None = None,
    ears: Ears | MelEars | None = None,
    eyes: Eyes | None = None,
    path: str | Path = SHIPPED,
) -> dict[str, Callable[..., Outcome]]:
    """What makes outcomes of the signals of each action that the bench can do for a network.

    Parameters
    ----------
    hand
        For weighing and squeezing; with the figures of `Hand` unless given.
    ears, eyes
        For sounds and images; with the models that ship unless given, for actions whose property has all of their
        labels as states. Other actions that need them are left out.
    path
        File of shapes and looks; it tells what the properties are called.

    Raises
    ------
    BenchError
        What was given for an action has no label that is a state of what the action measures.
    PalpateError
        Models of images need onnxruntime, which is not installed.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> sorted(estimates(load_network("household")))
    ['cat-vision', 'mat-sound', 'mat-vision', 'squeezing', 'weighing']
    """
    hand = hand or Hand()
    found: dict[str, Callable[..., Outcome]] = {}
    for action, deed in repertoire(network, read_roles(path)).items():
        if deed is weighing.weigh:
            found[action] = hand.mass
        elif deed is squeezing.squeeze:
            found[action] = hand.elasticity
        elif deed is knocking.knock:
            listener = ears or Ears(Classifier.load(SOUNDS))
            if _knows(network, action, listener.labels, given=ears is not None):
                found[action] = listener.label
        elif deed is looking.look:
            looker = eyes or _shipped_eyes(network, action)
            if action in looker.models and _knows(network, action, looker.models[action].model.tells, given=True):
                found[action] = looker.of(action)
    return found


def _shipped_eyes(network: Network, action: str) -> Eyes:
    """The first model that ships all of whose labels are states of what an action measures, if there is one."""
    for path in PICTURES:
        model = read_model(path)
        if _knows(network, action, model.tells, given=False):
            return Eyes({action: OnnxClassifier(model)})
    return Eyes()


def _knows(network: Network, action: str, labels: Sequence[str], *, given: bool) -> bool:
    """Whether labels are states of what an action measures: all of them, or, where they were given, some."""
    measured = network.properties[network.actions[action].sensor.property]
    states = measured.states if isinstance(measured, CategoricalProperty) else ()
    if given and not set(labels) & set(states):
        raise BenchError(
            f"action {action!r}: labels {', '.join(labels)} were found, expected states of {measured.name!r}: "
            f"{', '.join(states)}"
        )
    return given or set(labels) <= set(states)
