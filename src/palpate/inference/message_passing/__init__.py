"""The method of Kruzliak et al. (IROS 2024): messages between marginals, each node visited once."""

from palpate.inference.message_passing.belief import MessagePassingBelief
from palpate.inference.message_passing.settings import Settings

__all__ = ["MessagePassingBelief", "Settings"]
