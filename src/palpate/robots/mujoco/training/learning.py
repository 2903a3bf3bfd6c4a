"""Learning to tell images by a neural network, and writing it as an ONNX file; it needs the extra ``sound``.

The networks are PyTorch's own layers in a row, so that nothing here needs PyTorch until it is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError, extra

__all__ = ["Schedule", "compact", "fit", "resnet34", "write_onnx"]

Net = Any
"""A module of PyTorch."""
WIDTHS = (3, 16, 24, 32, 48)
CROP = (40, 40, 8, 16)
"""What the compact network does not look at, left, right, above and below: things stand in the middle [pixels]."""
DIMMEST, BRIGHTEST, GRAIN = 0.85, 1.15, 0.01
"""Each time that an image is learned from, it is a little brighter or darker, and has some noise."""


@dataclass(frozen=True)
class Schedule:
    """How long and how fast to learn."""

    epochs: int = 30
    batch: int = 64
    rate: float = 3e-3


def _torch() -> Any:
    try:
        import torch
    except ImportError as error:
        raise PalpateError(f"training needs PyTorch, which is not installed: {extra('sound')}") from error
    return torch


def compact(states: int, size: tuple[int, int]) -> Net:
    """Four convolutions and one layer of scores: 40 000 numbers for an image of 160 x 120.

    Parameters
    ----------
    size
        Width and height of the image [pixels].
    """
    nn = _torch().nn
    left, right, above, below = CROP
    width, height = size[0] - left - right, size[1] - above - below
    layers = [nn.ZeroPad2d((-left, -right, -above, -below))]
    for before, after in pairwise(WIDTHS):
        layers += [nn.Conv2d(before, after, 3, stride=2, padding=1, bias=False), nn.BatchNorm2d(after), nn.ReLU()]
        width, height = (width + 1) // 2, (height + 1) // 2
    return nn.Sequential(*layers, nn.Flatten(), nn.Dropout(0.3), nn.Linear(WIDTHS[-1] * width * height, states))


def resnet34(states: int) -> Net:
    """The paper's network, with random weights.

    Raises
    ------
    PalpateError
        If torchvision is not installed, or does not fit PyTorch.
    """
    torch = _torch()
    try:
        from torchvision.models import resnet34 as build
    # torchvision made for another PyTorch raises a RuntimeError
    except (ImportError, RuntimeError) as error:
        raise PalpateError(
            f"a ResNet34 needs torchvision that fits the installed PyTorch ({error}): {extra('sound')}"
        ) from error
    net = build(weights=None)
    net.fc = torch.nn.Linear(net.fc.in_features, states)
    return net


def fit(
    build: Callable[[], Net],
    images: NDArray[np.uint8],
    targets: NDArray[np.int64],
    seed: int,
    schedule: Schedule | None = None,
) -> Net:
    """Learn from images, (n, height, width, 3), and the number of the state of each, (n).

    Parameters
    ----------
    build
        Makes the network, after PyTorch's own generator was seeded.
    """
    torch, plan = _torch(), schedule or Schedule()
    torch.manual_seed(seed)
    rng, net = np.random.default_rng(seed), build()
    steps = plan.epochs * -(-len(targets) // plan.batch)
    optimiser = torch.optim.AdamW(net.parameters(), lr=plan.rate, weight_decay=1e-2)
    pace = torch.optim.lr_scheduler.OneCycleLR(optimiser, plan.rate, total_steps=steps)
    net.train()
    for _ in range(plan.epochs):
        order = rng.permutation(len(targets))
        for first in range(0, len(order), plan.batch):
            chosen = order[first : first + plan.batch]
            loss = torch.nn.functional.cross_entropy(
                net(torch.from_numpy(_varied(images[chosen], rng))), torch.from_numpy(targets[chosen])
            )
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            pace.step()
    net.eval()
    return net


def _varied(images: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.float32]:
    """A batch as networks take it, (n, 3, height, width), from -1 to 1 but for its variation."""
    bright = rng.uniform(DIMMEST, BRIGHTEST, (len(images), 1, 1, 1)).astype(np.float32)
    light = images.astype(np.float32) / 255 * bright
    light += GRAIN * rng.standard_normal(light.shape, dtype=np.float32)
    return np.ascontiguousarray((light.transpose(0, 3, 1, 2) - 0.5) / 0.5, dtype=np.float32)


def write_onnx(net: Net, size: tuple[int, int], path: Path) -> None:
    """Write a network that takes one image of this width and height as an ONNX file of scores."""
    import onnx

    torch = _torch()
    image = torch.zeros(1, 3, size[1], size[0])
    names = {"input_names": ["image"], "output_names": ["scores"]}
    program = torch.onnx.export(net, (image,), **names, dynamo=True, optimize=True, verbose=False)
    model = program.model_proto
    # where each node came from in whose folder is nobody's concern
    for part in (model.graph, *model.graph.node, *model.graph.value_info, *model.graph.initializer):
        del part.metadata_props[:]
        part.doc_string = ""
    del model.graph.value_info[:]
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString(deterministic=True))
