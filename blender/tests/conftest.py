"""Runs Blender without an interface, with the extension installed from its zip in a scratch folder, as a user would."""

import os
import tempfile
from pathlib import Path

_scratch = tempfile.TemporaryDirectory()
os.environ["BLENDER_USER_RESOURCES"] = _scratch.name

import bpy  # noqa: E402
import pytest  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]


def pytest_configure():
    (package,) = (ROOT / "target" / "blender").glob("*.zip")
    installed = bpy.ops.extensions.package_install_files(filepath=str(package), repo="user_default", enable_on_install=True)
    assert installed == {"FINISHED"}


@pytest.fixture
def data():
    return ROOT / "data"


@pytest.fixture(autouse=True)
def scene():
    """An empty scene with default settings."""
    for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.materials):
        bpy.data.batch_remove(list(kind))
    settings = bpy.context.scene.spectral_remesh
    for given in settings.bl_rna.properties:
        if given.identifier not in ("rna_type", "name"):
            settings.property_unset(given.identifier)
    return bpy.context.scene
