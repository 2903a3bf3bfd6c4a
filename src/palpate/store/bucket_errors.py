"""What goes wrong with a bucket, in one sentence each."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from palpate.store.errors import UnavailableError

__all__ = ["NotThereError", "told"]

KEYS = "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY"
METADATA = "169.254.169.254"
"""Where Amazon's own computers get keys; who is asked last where the environment has none."""
ANSWER = re.compile(r"<Code>(?P<code>[^<]*)</Code>.*?(?:<Message>(?P<message>[^<]*)</Message>|$)", re.DOTALL)
NO_ANSWER = re.compile(
    r"performing [A-Z]+ (?P<scheme>\w+)://(?P<host>[^/\s?]+).*?HTTP error: (?P<what>[^\n]+)", re.DOTALL
)


class NotThereError(Exception):
    """There is a bucket, and nothing under the key that was asked for."""


@contextmanager
def told(url: str) -> Iterator[None]:
    """Turn errors of obstore into sentences.

    Parameters
    ----------
    url
        The address of the bucket as it was given.

    Raises
    ------
    NotThereError
        If there is nothing under a key. As the answer to a HEAD has no text, a bucket that is not there may be the
        reason then.
    UnavailableError
        If anything else is wrong.
    """
    from obstore.exceptions import BaseError

    try:
        yield
    except (BaseError, OSError, ValueError) as error:
        # what follows repeats the error for who debugs obstore
        text = str(error).partition("\n\nDebug source:")[0]
        if isinstance(error, FileNotFoundError) and "NoSuchBucket" not in text:
            raise NotThereError from None
        raise UnavailableError(f"blobs {url!r}: {_sentence(text)}") from None


def _sentence(text: str) -> str:
    answer, silent = ANSWER.search(text), NO_ANSWER.search(text)
    if METADATA in text:
        return f"found no keys, expected {KEYS} in the environment"
    if "NoSuchBucket" in text:
        return "there is no such bucket, expected one that was made before"
    said = "" if answer is None else f" ({answer['code']}: {answer['message'] or 'no reason given'})"
    if "403 Forbidden" in text or "401 Unauthorized" in text:
        return f"access is denied{said}, expected {KEYS} of one who may read, write, list and remove objects there"
    if silent is not None:
        address = f"{silent['scheme']}://{silent['host']}"
        return f"no answer from {address} ({silent['what'].strip()}), expected the store's address in AWS_ENDPOINT_URL"
    first = text.partition("\n")[0].partition("<?xml")[0].strip(" :")
    return f"{first}{said}; expected a bucket such as s3://lab/blobs"
