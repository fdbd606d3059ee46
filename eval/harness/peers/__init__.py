"""The other remeshers and this one, each run as a separate process.

Each module here is one program:

    LABEL      its name in tables
    SETTINGS   the settings that it runs with, and why
    BY_PIP     whether it installs without a compiler
    COUNTS     whether it takes a number of vertices; otherwise it takes an edge length, tuned until the number fits

Programs have `missing()` (a reason, or None), `version()`, `command(source, target, wanted, sharp)` (a list of words)
and `seconds(output, target)` (of remeshing alone, from what was printed or written; None if not reported). Python
packages have PACKAGE, their name, and `load(path)`, `remesh(model, wanted, sharp)` and `save(model, path)`. They run in
a separate process, `python -m harness.peers NAME SOURCE TARGET WANTED [sharp]`, which prints the seconds of `remesh`.

Sources are PLY files written by harness.mesh. `sharp` says whether the model is a CAD part whose sharp edges must stay.
"""

import importlib
import importlib.metadata
import json
import sys

# In the order of tables: the program that is compared with the others comes first.
NAMES = ['remesh', 'ascent', 'meshlab', 'poisson', 'cgal', 'acvd', 'geogram', 'gpytoolbox', 'mmgs', 'meshlib',
         'instant_meshes', 'baby_shark']
OURS = ['remesh', 'ascent']


def peer(name):
    """Returns the program with this name, with the complete interface of a program."""
    module = importlib.import_module('.' + name, __package__)
    return _Package(name, module) if hasattr(module, 'PACKAGE') else module


class _Package:
    """A Python package as a program."""

    def __init__(self, name, module):
        self.name, self.module = name, module
        self.LABEL, self.SETTINGS = module.LABEL, module.SETTINGS
        self.BY_PIP, self.COUNTS = True, module.COUNTS

    def missing(self):
        try:
            importlib.metadata.version(self.module.PACKAGE)
            return None
        except importlib.metadata.PackageNotFoundError:
            return '%s is not installed' % self.module.PACKAGE

    def version(self):
        return '%s %s' % (self.module.PACKAGE, importlib.metadata.version(self.module.PACKAGE))

    def command(self, source, target, wanted, sharp):
        words = [sys.executable, '-m', __package__, self.name, source, target, str(wanted)]
        return words + ['sharp'] if sharp else words

    def seconds(self, output, _target):
        return last_json(output)['seconds']


def last_json(output):
    """Returns the JSON in the last line that a program printed."""
    return json.loads(output.strip().splitlines()[-1])


def edge_length(mesh, wanted):
    """Returns the edge length with which `wanted` vertices in hexagonal packing fill the area of the mesh."""
    return (2 * float(mesh.areas().sum()) / (3 ** 0.5 * wanted)) ** 0.5
