"""Restricted centroidal Voronoi remeshing (the paper's YR) by geogram's vorpalite, if it is on the path."""

import shutil
import subprocess

LABEL = 'geogram'
SETTINGS = '`remesh=true pts=N remesh:anisotropy=0` (its default profile is anisotropic)'
BY_PIP = False
COUNTS = True


def missing():
    return None if shutil.which('vorpalite') else 'no vorpalite on the path; no package has it'


def version():
    said = subprocess.run(['vorpalite', '--help'], capture_output=True, text=True).stdout
    return next((line.strip() for line in said.splitlines() if 'ersion' in line), 'geogram, version not told')


def command(source, target, wanted, _sharp):
    return ['vorpalite', source, target, 'remesh=true', 'pts=%d' % wanted, 'remesh:anisotropy=0']


def seconds(_output, _target):
    """Returns None, since vorpalite does not report its time; whole processes are compared."""
    return None
