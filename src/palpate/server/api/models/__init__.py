"""The form of answers, as the OpenAPI document tells it: a module for each kind of thing."""

from __future__ import annotations

from palpate.server.api.models.basics import Page, Strict
from palpate.server.api.models.entries import Entry
from palpate.server.api.models.episodes import Episode, EpisodeProgress, EpisodeRow
from palpate.server.api.models.objects import Change, Known, Object
from palpate.server.api.models.recordings import File, Recording, RecordingRow
from palpate.server.api.models.results import EntryRow, Property
from palpate.server.api.models.series import SeriesInfo, SeriesSamples
from palpate.server.api.models.setups import Device, Setup
from palpate.server.api.models.sharing import Sharing, SharingChange, Visibility
from palpate.server.api.models.uploads import Batch, Digests, KnownRecordings, Receipt
from palpate.server.api.models.users import NewToken, Token, TokenAsked, User

__all__ = [
    "Batch",
    "Change",
    "Device",
    "Digests",
    "Entry",
    "EntryRow",
    "Episode",
    "EpisodeProgress",
    "EpisodeRow",
    "File",
    "Known",
    "KnownRecordings",
    "NewToken",
    "Object",
    "Page",
    "Property",
    "Receipt",
    "Recording",
    "RecordingRow",
    "SeriesInfo",
    "SeriesSamples",
    "Setup",
    "Sharing",
    "SharingChange",
    "Strict",
    "Token",
    "TokenAsked",
    "User",
    "Visibility",
]
