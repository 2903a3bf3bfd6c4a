"""What `palpate infer` says: evidence read from JSON, and the belief it gives, as plain data."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from palpate.cli.surprise import impossible
from palpate.errors import EvidenceError, ImpossibleEvidenceError
from palpate.evidence import parse_item
from palpate.inference.belief import Belief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.admission import admit
from palpate.outcomes import Outcome

__all__ = ["Inferred", "answer", "infer", "read_document", "read_evidence"]

Json = dict[str, object]
QUANTILES = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class Inferred:
    """A belief, and how likely each piece of evidence was when it came.

    Parameters
    ----------
    prior
        The belief before the evidence.
    log_evidence_bits
        Sum of the log2 predictive densities; None where the engine cannot say.
    notices
        Every decision taken in reading the evidence, each with the place it is about.
    """

    prior: Belief
    belief: Belief
    surprises: tuple[float | None, ...]
    log_evidence_bits: float | None
    notices: tuple[str, ...]


def read_document(path: str) -> tuple[str, object]:
    """The name and the JSON value of a file, or of standard input for ``-``."""
    name = "standard input" if path == "-" else path
    try:
        text = sys.stdin.read() if path == "-" else Path(path).read_text(encoding="utf-8")
        return name, json.loads(text, parse_constant=_no_constant, object_pairs_hook=_no_repeated_keys)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise EvidenceError(f"{name}: no valid JSON at {place}: {error.msg}") from None
    except UnicodeDecodeError as error:
        raise EvidenceError(f"{name}: byte {error.start} is not UTF-8 text, expected JSON") from None
    except RecursionError:
        raise EvidenceError(f"{name}: the JSON is nested too deeply, expected an object with a list in it") from None
    except EvidenceError as error:
        raise EvidenceError(f"{name}: {error}") from None


def _no_constant(name: str) -> NoReturn:
    raise EvidenceError(f"{name} was found, expected finite numbers only")


def _no_repeated_keys(pairs: list[tuple[str, object]]) -> Json:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise EvidenceError(f"the key {twice!r} was found twice in one object, expected it once")
    return found


def read_evidence(name: str, document: object) -> list[tuple[str, Outcome]]:
    """The actions and outcomes in a document ``{"evidence": [...]}``, in its order."""
    if not isinstance(document, dict) or not isinstance(document.get("evidence"), list):
        raise EvidenceError(f'{name}: expected an object {{"evidence": [...]}} with a list of outcomes')
    unknown = [key for key in document if key != "evidence"]
    if unknown:
        raise EvidenceError(f"{name}: unknown key {unknown[0]!r}; the only key is 'evidence'")
    evidence = []
    for index, item in enumerate(document["evidence"]):
        try:
            evidence.append(parse_item(item))
        except EvidenceError as error:
            raise EvidenceError(f"{name}: evidence[{index}]: {error}") from None
    return evidence


def infer(name: str, prior: Belief, evidence: list[tuple[str, Outcome]]) -> Inferred:
    """The belief given the evidence, taken one by one in its order."""
    belief, surprises, notices = prior, [], []
    log_evidence: float | None = 0.0
    for index, (action, outcome) in enumerate(evidence):
        where = f"evidence[{index}]"
        try:
            told = admit(prior.network, action, outcome).notices
            surprises.append(_finite(belief.surprise(action, outcome)))
            if warning := impossible(surprises[-1]):
                told = (*told, warning)
            bits = belief.log2_predictive(action, outcome)
            belief = belief.update(action, outcome)
        except ImpossibleEvidenceError as error:
            raise ImpossibleEvidenceError(f"{name}: {where}: {error}") from None
        except EvidenceError as error:
            raise EvidenceError(f"{name}: {where}: {error}") from None
        log_evidence = None if log_evidence is None or bits is None else log_evidence + bits
        notices += [f"{where}: {notice}" for notice in told]
    return Inferred(prior, belief, tuple(surprises), _finite(log_evidence), tuple(notices))


def answer(inferred: Inferred) -> Json:
    """Belief, gains and surprises as they are printed by ``--json``; null is what cannot be said."""
    belief = inferred.belief
    gains = belief.expected_gains()
    return {
        "properties": {name: _marginal(belief, name) for name in belief.network.properties},
        "expected_gain_bits": {
            action: {str(objective): _finite(gain) for objective, gain in of_action.items()}
            for action, of_action in gains.items()
        },
        "log_evidence_bits": inferred.log_evidence_bits,
        "evidence": [
            {"action": observation.action, "surprise": surprise}
            for observation, surprise in zip(belief.evidence, inferred.surprises, strict=True)
        ],
    }


def _marginal(belief: Belief, name: str) -> Json:
    marginal = belief.marginal(name)
    entropy = _finite(marginal.entropy_bits)
    if isinstance(marginal, ContinuousMarginal):
        return {
            "unit": marginal.unit,
            "mean": _finite(marginal.mean),
            "sd": _finite(marginal.sd),
            "quantiles": {str(p): _finite(marginal.quantile(p)) for p in QUANTILES},
            "entropy_bits": entropy,
        }
    probabilities = dict(zip(marginal.states, marginal.probabilities.tolist(), strict=True))
    return {"probabilities": probabilities, "entropy_bits": entropy}


def _finite(value: float | None) -> float | None:
    """The value as a plain float; None for what cannot be said or is no number."""
    return float(value) if value is not None and math.isfinite(value) else None
