"""Draws pictures of meshes and of samples as PNG, without a display.

The meshes of a run no longer exist when its report is written, so the run itself draws its pictures."""

import os

import numpy as np
from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont

from . import library

PAPER, INK = (250, 250, 252), (51, 51, 51)
CAPTION = 30


def meshes(context, name, captions, paths, size=420, **options):
    """Draws meshes in a row with the example `render`, each with a caption, and returns the Markdown that shows the
    picture. Options are those of `render`."""
    panels = []
    for number, path in enumerate(paths):
        target = context.file('picture-%d.png' % number)
        words = [word for key, value in options.items() for word in ('--' + key, value)]
        library.example(context, 'render', path, target, '--size', size, *words)
        panels.append(Image.open(target).convert('RGB'))
    return _in_a_row(context, name, captions, panels)


def samples(context, name, captions, sets, surface, size=420, view=(30, 20)):
    """Draws sets of samples, each (positions, normals), as dots; `surface` is a dense set on the surface, which hides
    the samples behind it. `view` is azimuth and elevation in degrees, with z up."""
    right, up, towards = _camera(view)
    low = np.array([(surface[0] @ axis).min() for axis in (right, up)])
    high = np.array([(surface[0] @ axis).max() for axis in (right, up)])
    scale = 0.94 * size / (high - low).max()
    shape = np.ceil((high - low) * scale + 0.06 * size).astype(int)

    def places(points):
        across = np.stack([points @ right, points @ up], axis=1)
        return (across - 0.5 * (low + high)) * scale * [1, -1] + 0.5 * shape

    cells = 4
    front = np.full(tuple(shape // cells + 2), -np.inf)
    np.maximum.at(front, tuple((places(surface[0]) / cells).astype(int).T), surface[0] @ towards)
    panels = []
    for points, normals in sets:
        at = places(points)
        behind = front[tuple((at / cells).astype(int).T)] - points @ towards
        seen = (normals @ towards > 0) & (behind < 3 * cells / scale)
        panels.append(_dots(at[seen], shape, surface_mask=np.isfinite(front), cells=cells))
    return _in_a_row(context, name, captions, panels)


def _dots(places, shape, surface_mask, cells, fine=3):
    """Draws dots on the pale silhouette of the surface."""
    pale = np.where(surface_mask.T[..., None], (226, 232, 240), PAPER).astype(np.uint8)
    picture = Image.fromarray(pale).resize(np.array(surface_mask.shape) * cells * fine, Image.BILINEAR)
    draw = ImageDraw.Draw(picture)
    radius = 1.5 * fine
    for x, y in places * fine:
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=(20, 60, 110))
    return picture.crop((0, 0, *(shape * fine))).resize(tuple(shape), Image.LANCZOS)


def _camera(view):
    """Returns unit vectors to the right, up, and towards the camera, as in the example `render`."""
    a, e = np.radians(view)
    right = np.array([-np.sin(a), np.cos(a), 0])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    return right, np.cross(towards, right), towards


def _in_a_row(context, name, captions, panels):
    """Joins several pictures in one row, with captions above them."""
    height = max(panel.height for panel in panels)
    row = Image.new('RGB', (sum(panel.width for panel in panels), height + CAPTION), PAPER)
    draw, font, left = ImageDraw.Draw(row), ImageFont.truetype(findfont('DejaVu Sans'), 14), 0
    for caption, panel in zip(captions, panels):
        row.paste(panel, (left, CAPTION + (height - panel.height) // 2))
        draw.text((left + 0.5 * panel.width, 0.5 * CAPTION), caption, INK, font, anchor='mm')
        left += panel.width
    os.makedirs(context.figures, exist_ok=True)
    row.quantize(128).save(os.path.join(context.figures, name + '.png'), optimize=True)
    return '![](figures/%s.png)' % name
