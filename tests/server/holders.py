"""Stand-ins for who asks."""

from dataclasses import dataclass

__all__ = ["Somebody"]


@dataclass(eq=False)
class Somebody:
    network: str = "others"
    waited_s: float = 0.0
    is_ended: bool = False

    def end(self) -> None:
        self.is_ended = True
