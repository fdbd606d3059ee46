"""The other remeshers, and this one, all behind the same process boundary.

A module here is one program:

    LABEL      how tables call it
    SETTINGS   with what it runs, and why
    BY_PIP     whether it installs without a compiler
    COUNTS     whether it takes a number of vertices; if not, the length of edges, tuned until the number fits

Programs have `missing()` (a reason, or None), `version()`, `command(source, target, wanted, sharp)` (a list of words)
and `seconds(output, target)` (of remeshing alone, from what was printed or written; None where it is not told). Python
packages have PACKAGE, their name, and `load(path)`, `remesh(model, wanted, sharp)` and `save(model, path)`; they run as
a process of their own by `python -m harness.peers NAME SOURCE TARGET WANTED [sharp]`, which prints the seconds of
`remesh`.

Sources are PLY files that harness.mesh wrote. `sharp` is whether the model is a CAD part whose sharp edges are to stay.
"""

import importlib
import importlib.metadata
import json
import sys

# In the order of tables: the one that is compared comes first.
NAMES = ['remesh', 'ascent', 'meshlab', 'poisson', 'cgal', 'acvd', 'geogram', 'gpytoolbox', 'mmgs', 'meshlib',
         'instant_meshes', 'baby_shark']
OURS = ['remesh', 'ascent']


def peer(name):
    """The program of that name, with all that a program has."""
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
    """The JSON of the last line that a program printed."""
    return json.loads(output.strip().splitlines()[-1])


def edge_length(mesh, wanted):
    """The length of edges with which `wanted` vertices at hexagonal packing fill the area of the mesh."""
    return (2 * float(mesh.areas().sum()) / (3 ** 0.5 * wanted)) ** 0.5
