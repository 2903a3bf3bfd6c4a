"""The decorator that makes a function a recorded measurement."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

from palpate.recording.errors import RecordingError
from palpate.recording.measuring import About, Measuring, WhichThing
from palpate.recording.spool import Spool
from palpate.store.errors import StoreError
from palpate.store.records import Setup, ThingRef
from palpate.store.texts import check_name

__all__ = ["record"]

P = ParamSpec("P")
R = TypeVar("R")


def record(
    action: str,
    *,
    setup: Setup | str | Path | None = None,
    thing: WhichThing = None,
    property: str | None = None,
    about: About | None = None,
    keywords: Sequence[str] = (),
    spool: Spool | None = None,
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Record each call of a function as a measurement.

    The function keeps its signature, what it returns and what it raises; it may be a method or async. What it
    returns, an entry made by `Outcome`, several, or an outcome as robots return it, is the result. A call that raises
    is recorded as failed, with its log. When the call ends its recording is whole and on the disk.

    Parameters
    ----------
    action
        What the function does, as the network calls it.
    setup
        The devices, or the TOML file of them, which is read at the first call.
    thing
        The object, or a function that tells it from the arguments; `Recorder.thing` can tell it as well.
    property
        What an outcome is about which does not say so itself; the action's name unless given.
    about
        Whose the recordings are and what made them.
    keywords
        Lines of the log that hold one of them are kept apart too, as the file ``log/<keyword>.txt``.
    spool
        Where recordings are kept until a store has them; `default_folder` unless given.

    Raises
    ------
    RecordingError
        When decorated: if the function is a generator, a static or a class method (decorate what is inside), the
        action is empty, or the object or the spool is none. When called: if the recording cannot be begun, or not be
        finished; an exception of the function itself goes first.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from palpate.recording.recorder import current_recording
    >>> from palpate.recording.results import Outcome
    >>> from palpate.store.records import ThingRef
    >>> with TemporaryDirectory() as folder:
    ...     spool = Spool(folder)
    ...     @record("weighing", thing=ThingRef("ycb", "025_mug"), spool=spool)
    ...     def weigh(grams):
    ...         current_recording().series("scale", load=grams, units={"load": "g"}, rate_hz=10.0)
    ...         return Outcome.normal("mass", sum(grams) / len(grams), sd=6.0, unit="g")
    ...     result = weigh([117.0, 119.0])
    ...     [spool.read(name).entries == (result,) for name in spool.waiting()]
    [True]
    """
    _check_given(action, thing, spool)
    measuring = Measuring(action, setup, thing, property or action, about or About(), tuple(keywords), spool)

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        _check_decorable(function)
        if inspect.iscoroutinefunction(function):

            @wraps(function)
            async def waiting(*args: P.args, **kwargs: P.kwargs) -> Any:
                with measuring.one(args, kwargs) as returned:
                    returned.value = await function(*args, **kwargs)
                    return returned.value

            return cast("Callable[P, R]", waiting)

        @wraps(function)
        def measure(*args: P.args, **kwargs: P.kwargs) -> R:
            with measuring.one(args, kwargs) as returned:
                result = returned.value = function(*args, **kwargs)
                return result

        return measure

    return decorate


def _check_given(action: object, thing: object, spool: object) -> None:
    """Refuse what no recording could have, before there is a call."""
    try:
        check_name("action", action)
    except StoreError as error:
        raise RecordingError(f"@record: {error}") from None
    if not (thing is None or isinstance(thing, ThingRef) or callable(thing)):
        expected = 'a ThingRef, as ThingRef("our lab", "mug"), or a function that returns one'
        raise RecordingError(f"@record: thing: found {thing!r}, expected {expected}")
    if not (spool is None or isinstance(spool, Spool)):
        raise RecordingError(f'@record: spool: found {spool!r}, expected a Spool, as Spool("spool")')


def _check_decorable(function: Callable[..., Any]) -> None:
    name = getattr(function, "__qualname__", repr(function))
    if isinstance(function, staticmethod | classmethod):
        raise RecordingError(f"@record: {name} is a {type(function).__name__}, expected @record below that decorator")
    if inspect.isgeneratorfunction(function) or inspect.isasyncgenfunction(function):
        raise RecordingError(f"@record: {name} is a generator, expected a function that returns its result")
