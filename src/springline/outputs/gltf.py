"""Binary glTF 2.0 (Khronos): meshes with colours or pictures, put together piece by piece."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

from .. import __version__

if TYPE_CHECKING:
    import numpy as np

_COMPONENTS = {"float32": 5126, "uint8": 5121, "uint32": 5125}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_VERTICES, _INDICES = 34962, 34963
_LINEAR, _LINEAR_MIPMAPS, _CLAMP, _REPEAT = 9729, 9987, 33071, 10497


class Gltf:
    """One scene of one mesh.

    Args:
        name: Of the mesh, such as the asset's.
        extras: What readers should know of it.
    """

    def __init__(self, name: str, extras: dict[str, str]) -> None:
        self._name, self._extras = name, extras
        self._parts: list[bytes] = []
        self._size = 0
        self._lists: dict[str, list[dict[str, Any]]] = {}
        self._primitives: list[dict[str, Any]] = []

    def add(
        self,
        position: np.ndarray,
        triangles: np.ndarray,
        *,
        colour: np.ndarray | None = None,
        picture: tuple[np.ndarray, bytes] | None = None,
    ) -> None:
        """Add a piece of the mesh; one without a triangle is left out, as glTF allows no empty buffer.

        Args:
            position: (n, 3) float32 [m].
            triangles: (m, 3) uint32.
            colour: (n, 4) uint8, linear.
            picture: (n, 2) float32, where each vertex stands in the picture, from 0 to 1 right and down; and a PNG.
        """
        if not triangles.size:
            return
        box = {"min": position.min(axis=0).tolist(), "max": position.max(axis=0).tolist()}
        attributes = {"POSITION": self._accessor(position, _VERTICES, **box)}
        material: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
        if colour is not None:
            attributes["COLOR_0"] = self._accessor(colour, _VERTICES, normalized=True)
        if picture is not None:
            attributes["TEXCOORD_0"] = self._accessor(picture[0], _VERTICES)
            material["baseColorTexture"] = {"index": self._texture(picture[1])}
        self._primitives.append(
            {
                "attributes": attributes,
                "indices": self._accessor(triangles.reshape(-1, 1), _INDICES),
                "material": self._listed("materials", {"doubleSided": True, "pbrMetallicRoughness": material}),
            }
        )

    def content(self) -> bytes:
        """Return the file; its scene is empty when no piece was added."""
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": f"Springline {__version__}", "extras": self._extras},
            "scene": 0,
            "scenes": [{"nodes": [0]} if self._primitives else {"name": "no wall was seen"}],
        }
        if self._primitives:
            document |= {
                "nodes": [{"mesh": 0, "name": self._name}],
                "meshes": [{"name": self._name, "primitives": self._primitives}],
                "buffers": [{"byteLength": self._size}],
                **self._lists,
            }
        text = json.dumps(document, ensure_ascii=True, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        if self._parts:
            chunks += struct.pack("<II", self._size, 0x004E4942) + b"".join(self._parts)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _accessor(self, values: np.ndarray, target: int, **more: Any) -> int:
        return self._listed(
            "accessors",
            {
                "bufferView": self._view(values.tobytes(), target=target),
                "componentType": _COMPONENTS[values.dtype.name],
                "count": len(values),
                "type": _TYPES[values.shape[1]],
                **more,
            },
        )

    def _texture(self, png: bytes) -> int:
        """Add a picture that goes on round the wall and ends along it."""
        image = self._listed("images", {"bufferView": self._view(png), "mimeType": "image/png"})
        if "samplers" not in self._lists:
            filters = {"magFilter": _LINEAR, "minFilter": _LINEAR_MIPMAPS}
            self._listed("samplers", {**filters, "wrapS": _CLAMP, "wrapT": _REPEAT})
        return self._listed("textures", {"source": image, "sampler": 0})

    def _view(self, content: bytes, **more: Any) -> int:
        view = {"buffer": 0, "byteOffset": self._size, "byteLength": len(content), **more}
        padded = content + bytes(-len(content) % 4)
        self._parts.append(padded)
        self._size += len(padded)
        return self._listed("bufferViews", view)

    def _listed(self, kind: str, entry: dict[str, Any]) -> int:
        entries = self._lists.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1
