"""``mesh.spectral`` of every ``pyvista.PolyData``. PyVista finds it by itself; where it is older than entry points of
accessors, ``import spectral_remesh.accessor`` adds it."""

from __future__ import annotations

from typing import Any

import pyvista

from ._jobs import quality, remesh, sample
from ._mesh import Report


@pyvista.register_dataset_accessor("spectral", pyvista.PolyData)
class SpectralAccessor:
    """Remeshing of a ``pyvista.PolyData``; the options are those of the functions of the same names."""

    def __init__(self, mesh: pyvista.PolyData) -> None:
        self._mesh = mesh

    def remesh(self, **options: Any) -> pyvista.PolyData:
        """:func:`spectral_remesh.remesh` of this mesh, which stays as it is."""
        return remesh(self._mesh, **options).to_pyvista()

    def sample(self, **options: Any) -> pyvista.PolyData:
        """:func:`spectral_remesh.sample` of this mesh."""
        return sample(self._mesh, **options).to_pyvista()

    def quality(self, **options: Any) -> Report:
        """:func:`spectral_remesh.quality` of this mesh."""
        return quality(self._mesh, **options)
