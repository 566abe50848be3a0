"""Shards in WebDataset format: tar archives with the files of each sample next to each other.

Equal samples produce bit-identical archives: no times, no owners, and a fixed order.
"""

from __future__ import annotations

import contextlib
import gzip
import hashlib
import io
import json
import os
import struct
import tarfile
import uuid
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator

import numpy as np


@dataclass
class Sample:
    """An image and its metadata. `key` contains no dot."""

    key: str
    arrays: dict[str, np.ndarray]
    metadata: dict[str, Any]


def name(index: int, compress: bool) -> str:
    return f"shards/{index:06}.tar{'.gz' if compress else ''}"


class Writer:
    """Writes a shard to a temporary file and renames it when it is complete."""

    def __init__(self, folder: str, index: int, compress: bool) -> None:
        self.file = name(index, compress)
        self._path = Path(folder, self.file)
        self._part = self._path.with_name(f".{index:06}-{uuid.uuid4().hex}.part")
        self._compress = compress

    def __enter__(self) -> Writer:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._raw = open(self._part, "wb")
        self._hash = Hashed(self._raw)
        self._gzip = gzip.GzipFile("", "wb", 6, self._hash, mtime=0) if self._compress else None
        target: Any = self._gzip or self._hash
        self._tar = tarfile.open(fileobj=target, mode="w|", format=tarfile.USTAR_FORMAT)
        return self

    def add(self, sample: Sample) -> None:
        for ending, data in encoded(sample):
            entry = tarfile.TarInfo(f"{sample.key}.{ending}")
            entry.size, entry.mode = len(data), 0o644
            self._tar.addfile(entry, io.BytesIO(data))

    def close(self) -> dict[str, Any]:
        self._tar.close()
        if self._gzip:
            self._gzip.close()
        self._raw.flush()
        # Flush to disk before renaming, so that a power loss cannot leave a name without data.
        os.fsync(self._raw.fileno())
        self._raw.close()
        os.replace(self._part, self._path)
        return {"file": self.file, "sha256": self._hash.digest.hexdigest(), "bytes": self._hash.count}

    def __exit__(self, *_: Any) -> None:
        self._raw.close()
        with contextlib.suppress(FileNotFoundError):
            self._part.unlink()


class Hashed:
    """A writable file that hashes its data."""

    def __init__(self, file: Any) -> None:
        self._file, self.digest, self.count = file, hashlib.sha256(), 0

    def write(self, data: Any) -> int:
        self._file.write(data)
        self.digest.update(data)
        self.count += len(data)
        return len(data)

    def flush(self) -> None:
        self._file.flush()


def encoded(sample: Sample) -> Iterator[tuple[str, bytes]]:
    """Yield extensions and bytes. All WebDataset readers support ``.png``, ``.npy`` and ``.json``."""
    for output, array in sample.arrays.items():
        if output == "color":
            yield "color.png", png(array)
        else:
            data = io.BytesIO()
            np.lib.format.write_array(data, np.ascontiguousarray(array), version=(1, 0), allow_pickle=False)
            yield f"{output}.npy", data.getvalue()
    yield "json", json.dumps(sample.metadata, sort_keys=True).encode()


def png(picture: np.ndarray) -> bytes:
    """Encode an sRGB image, bytes [h, w, 3 or 4], as PNG."""
    height, width, channels = picture.shape
    rows = picture.reshape(height, -1)
    # PNG filter "up": differences to the row above.
    lines = np.full((height, 1 + rows.shape[1]), 2, np.uint8)
    lines[0, 1:] = rows[0]
    lines[1:, 1:] = rows[1:] - rows[:-1]

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    # The sRGB chunk declares the color space, with perceptual intent.
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            chunk(b"IHDR", header),
            chunk(b"sRGB", b"\0"),
            chunk(b"IDAT", zlib.compress(lines.tobytes(), 6)),
            chunk(b"IEND", b""),
        ]
    )


def read(path: str | os.PathLike[str]) -> Iterator[tuple[str, dict[str, bytes]]]:
    """Yield the samples of a shard: key, and bytes by extension."""
    key, files = None, {}
    with tarfile.open(path, "r|*") as tar:
        for entry in tar:
            file = tar.extractfile(entry)
            if file is None:
                continue
            stem, _, ending = entry.name.partition(".")
            if stem != key and key is not None:
                yield key, files
                files = {}
            key = stem
            files[ending] = file.read()
    if key is not None:
        yield key, files
