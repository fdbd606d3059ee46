"""Plots as SVG, with a uniform style, and with the same bytes for the same figures."""

import os

import matplotlib

matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402

# Colour-blind safe (Okabe, Ito 2008).
OURS, THEIRS, THIRD, FOURTH, INK, PALE = '#0072B2', '#D55E00', '#009E73', '#CC79A7', '#333333', '#BBBBBB'

STYLE = {
    'svg.hashsalt': 'remesh', 'svg.fonttype': 'path',
    'font.family': 'DejaVu Sans', 'font.size': 9, 'axes.titlesize': 10, 'axes.labelsize': 9, 'legend.fontsize': 8,
    'axes.edgecolor': INK, 'axes.labelcolor': INK, 'text.color': INK, 'xtick.color': INK, 'ytick.color': INK,
    'axes.spines.top': False, 'axes.spines.right': False, 'axes.linewidth': 0.8, 'axes.titlelocation': 'left',
    'axes.grid': True, 'grid.color': '#E6E6E6', 'grid.linewidth': 0.6, 'axes.axisbelow': True,
    'legend.frameon': False, 'lines.linewidth': 1.6, 'lines.markersize': 4, 'figure.constrained_layout.use': True,
    'figure.facecolor': 'white', 'savefig.facecolor': 'white',
}
plt.rcParams.update(STYLE)


def panels(rows, columns, width=3.4, height=2.7, **more):
    """Returns a figure with a grid of axes; width and height of each in inches."""
    return plt.subplots(rows, columns, figsize=(width * columns, height * rows), squeeze=False, **more)


def save(figure, figures, name):
    """Writes figures/NAME.svg and returns the Markdown that shows it."""
    figure.savefig(os.path.join(figures, name + '.svg'), metadata={'Date': None, 'Creator': None})
    plt.close(figure)
    return '![](figures/%s.svg)' % name


def bare(axes):
    """Removes ticks and frame, and sets equal scales on both axes, for pictures of points."""
    axes.set_aspect('equal')
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(False)
