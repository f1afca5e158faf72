# SPDX-License-Identifier: Apache-2.0
"""The encoder, which compares images with words: open_clip's models, and the image tower of the embedded one."""

import logging
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
import torch.nn.functional as F
from timm.models import register_model
from torch import Tensor, nn

from ..schema.errors import VibeError

PATCH = 4
GRID = 5  # cells along one side of the last grid of features
_REMEDY = "Use the embedded encoder (leave --encoder out), or a tag such as ViT-B-32-256/datacomp_s34b_b86k."


class Block(nn.Module):
    """Two 3 × 3 convolutions and a shortcut; a `stride` of 2 halves the image."""

    def __init__(self, inputs: int, outputs: int, stride: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False)
        self.first_norm = nn.BatchNorm2d(outputs)
        self.second = nn.Conv2d(outputs, outputs, 3, 1, 1, bias=False)
        self.second_norm = nn.BatchNorm2d(outputs)
        self.shortcut = nn.Sequential()
        if inputs != outputs:
            self.shortcut = nn.Sequential(
                nn.AvgPool2d(stride, ceil_mode=True), nn.Conv2d(inputs, outputs, 1, bias=False), nn.BatchNorm2d(outputs)
            )

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) → (B, outputs, H / stride, W / stride)."""
        inner = F.relu(self.first_norm(self.first(x)), inplace=True)
        return F.relu(self.second_norm(self.second(inner)) + self.shortcut(x))


class Stem(nn.Module):
    """A linear projection of patches, plus convolutions that tell sharp edges (gloss, hard light) from blurred ones."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.patches = nn.Conv2d(6, outputs, PATCH, PATCH, bias=False)
        self.edges = nn.Sequential(
            nn.Conv2d(6, outputs // 2, 3, 2, 1, bias=False),
            nn.BatchNorm2d(outputs // 2),
            nn.ReLU(inplace=True),
            nn.Conv2d(outputs // 2, outputs, 3, 2, 1, bias=False),
        )

    def forward(self, x: Tensor) -> Tensor:
        """(B, 3, H, W) display values v as (v − 0.5) / 0.25 → (B, outputs, H / 4, W / 4)."""
        both = with_logarithm(x)
        return self.patches(both) + self.edges(both)


def with_logarithm(x: Tensor) -> Tensor:
    """An image (B, 3, H, W) of display values v as (v − 0.5) / 0.25, and its logarithm, as six channels.

    The light multiplies a surface's color; in the logarithm both add up. So shade, a color cast of the light or a highlight
    changes every color in the same way. The 0.03 is added so that noise in black hardly counts.
    """
    return torch.cat([x, torch.log((0.25 * x + 0.5).clamp_min(0) + 0.03) + 1], 1)


class Tower(nn.Sequential):
    """Images (B, 3, H, W) → features (B, features), by plain residual blocks on a patch stem (He et al. 2016).

    Pooling forgets where things are, but "lit from the left" and "dark corners" are about places: the projection takes the whole
    last grid. `stem` makes, for a number of channels, a module that turns images into a grid of a fourth of their width and height.
    """

    def __init__(
        self,
        features: int,
        stem: Callable[[int], nn.Module],
        widths: tuple[int, ...],
        depths: tuple[int, ...],
        strides: tuple[int, ...],
    ) -> None:
        layers: list[nn.Module] = [stem(widths[0]), nn.BatchNorm2d(widths[0]), nn.ReLU(inplace=True)]
        inputs = widths[0]
        for width, depth, stride in zip(widths, depths, strides, strict=True):
            for k in range(depth):
                layers.append(Block(inputs, width, 1 if k else stride))
                inputs = width
        layers += [nn.AdaptiveAvgPool2d(GRID), nn.Flatten(), nn.Linear(inputs * GRID**2, features)]
        super().__init__(*layers)


@register_model
def vibe_resnet(pretrained: bool = False, num_classes: int = 128, **unused: Any) -> Tower:
    """The tower for `timm_model_name: "vibe_resnet"` in an open_clip configuration; `pretrained` has no effect."""
    return Tower(num_classes, Stem, (32, 64, 96, 160), (2, 2, 2, 2), (1, 2, 2, 1))


EMBEDDED = Path(__file__).with_name("embedded")  # the encoder that guides by default
MERGES = "merges.txt.gz"  # byte-pair merges of an encoder folder's own vocabulary, for open_clip's tokenizer


class Encoder:
    """A frozen encoder of images and texts with its own preprocessing; `name` is the name that the user gave."""

    def __init__(self, name: str, model: Any, tokenizer: Any, device: torch.device) -> None:
        self.name, self.device = name, device
        # Channels last is a fifth faster for convolutions on the CPU.
        self._model = model.to(device, memory_format=torch.channels_last).eval().requires_grad_(False)
        self._tokenizer, self._config = tokenizer, model.visual.preprocess_cfg
        size = self._config["size"]
        self.size: int = size if isinstance(size, int) else size[0]  # pixels, of a square
        mean_and_deviation = (self._config["mean"], self._config["std"])
        self._mean, self._std = torch.tensor(mean_and_deviation, device=device)[..., None, None]

    def encode_images(self, pictures: Tensor) -> Tensor:
        """Unit features (B, D) of images (B, 3, H, W) in [0, 1] of any size, differentiable in them."""
        return F.normalize(self._model.encode_image(self.preprocess(pictures)).float(), dim=-1)

    @torch.no_grad()
    def encode_texts(self, texts: list[str]) -> Tensor:
        """Unit features (B, D) of sentences."""
        return F.normalize(self._model.encode_text(self._tokenizer(texts).to(self.device)).float(), dim=-1)

    def preprocess(self, pictures: Tensor) -> Tensor:
        """Images (B, 3, H, W) in [0, 1], as the model expects them: resized, cropped or padded, and normalized.

        The result (B, 3, size, size) is differentiable in them.
        """
        height, width = pictures.shape[-2:]
        pick = {"shortest": min, "longest": max}.get(self._config.get("resize_mode", "shortest"))
        scale = self.size / pick(height, width) if pick else None
        target = (round(height * scale), round(width * scale)) if scale else (self.size, self.size)
        if (height, width) != target:
            mode = self._config.get("interpolation", "bicubic")
            pictures = F.interpolate(pictures, target, mode=mode, antialias=True, align_corners=False)
        top, left = (target[0] - self.size) // 2, (target[1] - self.size) // 2
        if top or left:  # negative padding crops
            pictures = F.pad(pictures, (-left, self.size - target[1] + left, -top, self.size - target[0] + top))
        return (pictures.clamp(0, 1) - self._mean) / self._std


def load_encoder(spec: str | None = None, device: str | torch.device = "cpu") -> Encoder:
    """Loads an encoder; raises VibeError if it is unknown, incomplete or out of reach.

    `spec` is None or "embedded" for the shipped encoder, "MODEL/PRETRAINED" (an open_clip tag, downloaded once),
    "hf-hub:OWNER/NAME", or a folder with ``open_clip_config.json`` and weights.
    """
    import open_clip  # slow to import: only when an encoder is wanted

    name = spec or "embedded"
    place = EMBEDDED if name == "embedded" else Path(name).expanduser()
    if place.is_file():
        place = place.parent
    logging.disable(logging.CRITICAL)  # the libraries log every retry; the user gets one line
    try:
        if name == "embedded" or place.is_dir():
            source, pretrained = f"local-dir:{place}", None
            if not (place / "open_clip_config.json").is_file():
                raise VibeError(f"The encoder folder {str(place)!r} has no open_clip_config.json.", _REMEDY)
        elif name.startswith("hf-hub:"):
            source, pretrained = name, None
            _check_reachable(name, name.removeprefix("hf-hub:"))
        else:
            source, _, pretrained = name.partition("/")
            if pretrained not in open_clip.list_pretrained_tags_by_model(source):
                raise VibeError(f"open_clip knows no encoder {name!r}.", _REMEDY)
            config = open_clip.get_pretrained_cfg(source, pretrained)
            _check_reachable(name, config.get("hf_hub", "").rstrip("/"))
        model = open_clip.create_model(source, pretrained=pretrained, require_pretrained=True)
        own = {"bpe_path": str(place / MERGES)} if (place / MERGES).is_file() else {}
        tokenizer = open_clip.get_tokenizer(source, **own)
    except VibeError:
        raise
    except Exception as error:  # of a download or a foreign file: one line for the user
        reason = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
        raise VibeError(f"The encoder {name!r} cannot be loaded: {reason.rstrip('.')}.", _REMEDY) from error
    finally:
        logging.disable(logging.NOTSET)
    return Encoder(name, model, tokenizer, torch.device(device))


def _check_reachable(name: str, repository: str) -> None:
    """Raises VibeError if a model is not cached and the hub does not answer; the hub's own retries take a minute."""
    from huggingface_hub import constants

    if not repository or Path(constants.HF_HUB_CACHE, f"models--{repository.replace('/', '--')}", "snapshots").exists():
        return
    try:
        urllib.request.urlopen(constants.ENDPOINT, timeout=8.0).close()
    except urllib.error.HTTPError:
        return  # it answers
    except OSError as error:
        reason = f"{constants.ENDPOINT} does not answer ({getattr(error, 'reason', error)})"
        raise VibeError(
            f"The encoder {name!r} cannot be downloaded: {reason}.",
            "Connect to the internet once, or pass a local open_clip folder, or leave --encoder out to use the embedded one.",
        ) from error
