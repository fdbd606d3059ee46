"""The accessor ``mesh.spectral`` of every ``pyvista.PolyData``. PyVista finds it automatically. For versions without entry
points for accessors, ``import spectral_remesh.accessor`` adds it."""

from __future__ import annotations

from typing import Any

import pyvista

from ._jobs import quality, remesh, sample
from ._mesh import Report


@pyvista.register_dataset_accessor("spectral", pyvista.PolyData)
class SpectralAccessor:
    """Remeshes a ``pyvista.PolyData``. Options are those of the functions with the same names."""

    def __init__(self, mesh: pyvista.PolyData) -> None:
        self._mesh = mesh

    def remesh(self, **options: Any) -> pyvista.PolyData:
        """Calls :func:`spectral_remesh.remesh` on this mesh, which is not changed."""
        return remesh(self._mesh, **options).to_pyvista()

    def sample(self, **options: Any) -> pyvista.PolyData:
        """Calls :func:`spectral_remesh.sample` on this mesh."""
        return sample(self._mesh, **options).to_pyvista()

    def quality(self, **options: Any) -> Report:
        """Calls :func:`spectral_remesh.quality` on this mesh."""
        return quality(self._mesh, **options)
