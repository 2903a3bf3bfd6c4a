"""Looking: a classifier as an ONNX file, with a map from its labels to a network's states."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError, extra
from palpate.estimators.signals import EstimatorError
from palpate.outcomes import Failed, Posterior

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

__all__ = ["Model", "OnnxClassifier", "read_model"]

FLAT_SD = 1.0
"""An image whose grey levels differ by less, of 255, shows nothing."""
SUM_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Model:
    """What an ONNX file does not say of itself.

    Attributes
    ----------
    path
        The ONNX file: one image in, (1, 3, height, width) of float32; scores or probabilities out, (1, k).
    labels
        The k labels in the order of the output.
    label_map
        Label of the model to the label that the network knows; others stay as they are, and what no network knows is
        dealt with as any unknown label is.
    training_prior
        State to its share of the training data; uniform where it is None.
    temperature
        Of the probabilities, see `palpate.outcomes.Posterior`.
    mean, sd
        Of the pixels in training, by channel, from 0 to 1.
    nothing
        The label of images that show none of the others, if there is one: where it is the likeliest, looking failed,
        and otherwise it does not count.
    source
        What it was trained on, and how.
    """

    path: Path
    labels: tuple[str, ...]
    label_map: Mapping[str, str] = field(default_factory=dict)
    training_prior: Mapping[str, float] | None = None
    temperature: float = 1.0
    mean: tuple[float, float, float] = (0.5, 0.5, 0.5)
    sd: tuple[float, float, float] = (0.5, 0.5, 0.5)
    nothing: str | None = None
    source: str = ""

    def __post_init__(self) -> None:
        if self.nothing is not None and self.nothing not in self.labels:
            raise EstimatorError(f"{self.path}: nothing = {self.nothing!r} was found, expected one of its labels")
        prior = self.training_prior
        for name, right, expected in (
            ("labels", _are_names(self.labels), "a list of names"),
            ("mean", _are_numbers(self.mean, 3), "three numbers"),
            ("sd", _are_numbers(self.sd, 3, above=0.0), "three numbers above zero"),
            ("temperature", _are_numbers((self.temperature,), 1, above=0.0), "a number above zero"),
            ("label_map", _is_table(self.label_map) and _are_names(self.label_map.values()), "a table of names"),
            ("training_prior", prior is None or _is_prior(prior), "a table of numbers above zero"),
        ):
            if not right:
                raise EstimatorError(f"{self.path}: {name} = {getattr(self, name)!r} was found, expected {expected}")

    @property
    def tells(self) -> tuple[str, ...]:
        """What it may tell: its labels as the network knows them, without that of nothing."""
        told = (label for label in self.labels if label != self.nothing)
        return tuple(dict.fromkeys(self.label_map.get(label, label) for label in told))


def read_model(path: str | Path) -> Model:
    """Read what is said of a model from a TOML file beside it.

    Its keys are the fields of `Model`; ``path`` is relative to the TOML file.

    Raises
    ------
    EstimatorError
        If a key is missing, unknown, or of another kind.
    """
    file = Path(path)
    try:
        plain = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise EstimatorError(f"{file}: cannot be read ({error}), expected a TOML file about a model") from None
    unknown = sorted(set(plain) - set(Model.__dataclass_fields__))
    if unknown or not {"path", "labels"} <= set(plain):
        told = f"unknown key {unknown[0]!r}" if unknown else "path or labels are missing"
        raise EstimatorError(f"{file}: {told}, expected {', '.join(Model.__dataclass_fields__)}")
    listed: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in plain.items()}
    return Model(**{**listed, "path": file.parent / str(plain["path"])})


class OnnxClassifier:
    """Labels from an image by a model in the ONNX format; it needs the extra ``vision``.

    Parameters
    ----------
    model
        The file and what is known of it.

    Raises
    ------
    EstimatorError
        If the file is no model, or its input or output is not as expected: as many outputs as labels.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._session = _session(model.path)
        self._input = self._session.get_inputs()[0]
        shape = self._input.shape
        if len(shape) != 4 or shape[1] not in (3, "3") or not all(isinstance(size, int) for size in shape[2:]):
            raise EstimatorError(f"{model.path}: takes {shape}, expected (1, 3, height, width)")
        self._size = (int(shape[2]), int(shape[3]))
        told = self._scores(np.zeros((1, 3, *self._size), dtype=np.float32)).size
        if told != len(model.labels):
            raise EstimatorError(
                f"{model.path}: gives {told} numbers, expected one for each of {len(model.labels)} labels"
            )

    def outcome(self, image: NDArray[np.uint8]) -> Posterior | Failed:
        """Probabilities of the network's labels, which sum to one; failed where the image shows nothing.

        Parameters
        ----------
        image
            Red, green and blue, (height, width, 3), of any size; it is scaled to what the model takes.

        Raises
        ------
        EstimatorError
            If it is no such image.
        """
        found = np.asarray(image)
        if found.dtype != np.uint8 or found.ndim != 3 or found.shape[2] != 3 or found.size == 0:
            raise EstimatorError(
                f"image: found {found.dtype} of shape {found.shape}, expected uint8 of (height, width, 3)"
            )
        if found.std() < FLAT_SD:
            return Failed(f"the image is one colour: its levels differ by {found.std():.2g} of 255")
        scores = self._scores(self._prepared(found))
        if not np.all(np.isfinite(scores)):
            return Failed("the model gives numbers that are not finite")
        shares = _shares(scores)
        if self.model.labels[int(np.argmax(shares))] == self.model.nothing:
            return Failed("the image shows nothing that the model knows")
        return Posterior(self._named(shares), self.model.training_prior, self.model.temperature)

    def _prepared(self, image: NDArray[np.uint8]) -> NDArray[np.float32]:
        from PIL import Image

        height, width = self._size
        scaled = np.asarray(Image.fromarray(image).resize((width, height)), dtype=np.float32) / 255
        normal = (scaled - np.array(self.model.mean, np.float32)) / np.array(self.model.sd, np.float32)
        return np.ascontiguousarray(normal.transpose(2, 0, 1)[None], dtype=np.float32)

    def _scores(self, batch: NDArray[np.float32]) -> NDArray[np.float64]:
        (found, *_) = self._session.run(None, {self._input.name: batch})
        return np.asarray(found, dtype=np.float64).ravel()

    def _named(self, shares: NDArray[np.float64]) -> dict[str, float]:
        probabilities: dict[str, float] = {}
        for label, share in zip(self.model.labels, shares, strict=True):
            if label != self.model.nothing:
                known = self.model.label_map.get(label, label)
                probabilities[known] = probabilities.get(known, 0.0) + float(share)
        total = sum(probabilities.values())
        return {label: share / total for label, share in probabilities.items()}


def _shares(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Probabilities, which sum to one, from probabilities or logits."""
    if np.any(scores < 0) or abs(scores.sum() - 1) > SUM_TOLERANCE:
        scores = np.exp(scores - scores.max())
    return np.asarray(scores / scores.sum())


def _are_names(values: object) -> bool:
    return isinstance(values, Iterable) and not isinstance(values, str) and all(isinstance(v, str) for v in values)


def _are_numbers(values: object, count: int, above: float = -np.inf) -> bool:
    if not isinstance(values, Collection) or len(values) != count:
        return False
    return all(isinstance(v, int | float) and not isinstance(v, bool) and above < v < np.inf for v in values)


def _is_table(values: object) -> bool:
    return isinstance(values, Mapping)


def _is_prior(values: object) -> bool:
    return isinstance(values, Mapping) and bool(values) and _are_numbers(values.values(), len(values), above=0.0)


def _session(path: Path) -> InferenceSession:
    try:
        import onnxruntime
        from onnxruntime.capi import onnxruntime_pybind11_state as errors
    except ImportError as error:
        raise PalpateError(f"models need onnxruntime, which is not installed: {extra('vision')}") from error
    if not path.is_file():
        raise EstimatorError(f"{path}: there is no such file, expected an ONNX model")
    options = onnxruntime.SessionOptions()
    # one image at a time: more threads only wait for each other
    options.intra_op_num_threads = 1
    options.log_severity_level = 4
    broken = (errors.InvalidProtobuf, errors.InvalidGraph, errors.Fail, errors.InvalidArgument, errors.NotImplemented)
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except broken as error:
        raise EstimatorError(f"{path}: is no ONNX model that can be run ({error})") from None
