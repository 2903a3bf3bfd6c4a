"""What an answer says of itself while it is sent."""

from __future__ import annotations

from starlette.types import Message, Send

__all__ = ["Sending"]


class Sending:
    """Sends on what it gets; `status` is that of the answer, None until one has begun."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self.status: int | None = None

    async def __call__(self, message: Message) -> None:
        """Send on a part of an answer."""
        if message["type"] == "http.response.start":
            self.status = message["status"]
        await self._send(message)
