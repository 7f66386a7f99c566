"""One table of the formats that results are exported in."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ...survey import Survey

_LIBRARIES = {"gis": ("pyogrio",), "excel": ("openpyxl",), "dxf": ("ezdxf",)}


@dataclass(frozen=True)
class Export:
    """One format of export.

    Args:
        key: What `format=` and `--to` call it.
        title: For people.
        extensions: By habit, with the dot; the first one is written.
        holds: What of the results is in it, for people.
        writer: "module:function" in this package.
        extra: Optional dependency that it needs, or None.
        folder: The file by which the folder that it writes is told; empty where it writes a file.
    """

    key: str
    title: str
    extensions: tuple[str, ...]
    holds: str
    writer: str
    extra: str | None = None
    folder: str = ""

    @property
    def libraries(self) -> tuple[str, ...]:
        """Modules of the optional dependency that it needs."""
        return _LIBRARIES.get(self.extra or "", ())

    def write_function(self) -> Callable[[Survey, Path], None]:
        """Return the function that writes it."""
        module, name = self.writer.split(":")
        return getattr(import_module(f".{module}", __package__), name)


EXPORTS = {
    e.key: e
    for e in (
        Export("gpkg", "GeoPackage", (".gpkg",), "centreline, stations, features", "geopackage:write_geopackage",
               "gis"),
        Export("landxml", "LandXML 1.2 alignment and profile", (".landxml.xml", ".landxml"), "centreline",
               "landxml:write_landxml"),
        Export("glb", "glTF 2.0 binary mesh", (".glb",), "wall, coloured by its departure", "meshes:write_gltf"),
        Export("obj", "OBJ mesh with vertex colours", (".obj",), "wall, coloured by its departure",
               "meshes:write_obj"),
        Export("ply-mesh", "PLY mesh with vertex colours", (".mesh.ply",), "wall, with its departures",
               "meshes:write_ply_mesh"),
        Export("vtu", "VTK XML unstructured grid, for ParaView", (".vtu",), "wall, with its departures",
               "vtk:write_vtu"),
        Export("dxf", "DXF drawing of sections [mm]", (".dxf",), "fitted sections, nominal circle, readings",
               "dxf:write_dxf", "dxf"),
        Export("xlsx", "Excel workbook", (".xlsx",), "summary, stations, one-sigma, features, corrections",
               "excel:write_excel", "excel"),
        Export("isybau", "ISYBAU XML 2013-02: condition data", (".isybau.xml",), "features or observations",
               "isybau:write_isybau"),
        Export("isybau-2006", "ISYBAU XML 2006-10: condition data", (".isybau-2006.xml",),
               "features or observations", "isybau:write_isybau_2006"),
        Export("m150", "DWA-M 150 XML, type B", (".m150.xml",), "features or observations", "m150:write_m150"),
        Export("en13508", "EN 13508-2 exchange text", (".en13508.txt",), "features or observations",
               "en13508:write_en13508"),
        Export("pacp", "folder of CSV tables with the columns of PACP 6: a mapping, not the certified database",
               (".pacp",), "features or observations", "pacp:write_pacp", folder="Conditions.csv"),
        Export("reach-csv", "one row per reach: least, mean and largest height, width, inner perimeter, ovality",
               (".reach.csv",), "profile measures", "tables:write_reach"),
        Export("fdot-430", "FDOT Section 430 laser profile table [ft, in]", (".fdot-430.csv",),
               "diameters and deflection by the foot", "tables:write_fdot"),
    )
}  # fmt: skip
"""All formats of export by key."""
