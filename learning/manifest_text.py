"""The manifest in a safetensors file: JSON in its metadata, read without its tensors."""

import json
from typing import TypeVar

from pydantic import BaseModel, ValidationError

MANIFEST = "manifest"
"""Its name in the metadata."""
_LENGTH_BYTES = 8
"""A safetensors file begins with the length of its JSON header."""

AnyManifest = TypeVar("AnyManifest", bound=BaseModel)


def read_manifest(content: bytes, model: type[AnyManifest], lacking: str) -> AnyManifest:
    """Return the manifest in the `content` of a file that safetensors can load.

    Raises ValueError where there is none, which says that `lacking` follows, or where it is not
    valid.
    """
    length = int.from_bytes(content[:_LENGTH_BYTES], "little")
    header = json.loads(content[_LENGTH_BYTES : _LENGTH_BYTES + length])
    text = header.get("__metadata__", {}).get(MANIFEST)
    if text is None:
        raise ValueError(f"has no {MANIFEST} in its metadata, so {lacking}")
    try:
        return model.model_validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "it"
        raise ValueError(f"its {MANIFEST} is not valid: {place}: {first['msg']}") from error
