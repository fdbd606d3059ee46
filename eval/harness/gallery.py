"""Draws the pictures of docs/gallery.md from the results of the commands on that page."""

import os
import re
import subprocess

from . import pictures
from .context import ROOT, Context

PAGE = os.path.join(ROOT, 'docs', 'gallery.md')
FIGURES = os.path.join(ROOT, 'docs', 'pictures')

COMMANDS = re.compile(r'^```sh\n(.*?)^```$', re.MULTILINE | re.DOTALL)
# <!-- draw NAME: FILE "CAPTION", FILE "CAPTION" --view A,E -->, with the options of the example `render`.
PICTURE = re.compile(r'^<!-- draw (\w+): (.*) -->$', re.MULTILINE)
PANEL = re.compile(r'([\w./]+) "([^"]*)"')
OPTION = re.compile(r'--(\w+) (\S+)')


def draw(scratch):
    """Runs the commands of the page in an empty folder, draws its pictures, and returns their paths."""
    context = Context(cases=[], scratch=scratch, figures=FIGURES)
    os.symlink(os.path.join(ROOT, 'data'), context.file('data'))
    with open(PAGE, encoding='utf-8') as f:
        page = f.read()
    path = os.path.dirname(context.binary) + os.pathsep + os.environ['PATH']
    for commands in COMMANDS.findall(page):
        subprocess.run(['sh', '-eu', '-c', commands], cwd=scratch, env={**os.environ, 'PATH': path}, check=True,
                       stdout=subprocess.DEVNULL)
    return [_draw(context, name, words) for name, words in PICTURE.findall(page)]


def _draw(context, name, words):
    panels = PANEL.findall(words)
    options = dict(OPTION.findall(PANEL.sub('', words)))
    pictures.meshes(context, name, [caption for _, caption in panels], [context.file(path) for path, _ in panels],
                    size=330, **options)
    return os.path.join(FIGURES, name + '.png')
