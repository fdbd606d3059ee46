"""The display of meshes in a notebook."""

from __future__ import annotations

import base64
import re
import struct

from conftest import torus

import spectral_remesh as sr


def test_a_notebook_shows_a_picture_and_a_table():
    remeshed = sr.remesh(*torus(), points=300)
    html = remeshed._repr_html_()
    found = re.search(r'src="data:image/png;base64,([^"]+)"', html)
    assert found is not None
    png = base64.b64decode(found[1])
    width, height = struct.unpack(">II", png[16:24])
    assert png.startswith(b"\x89PNG") and max(width, height) == 360 and min(width, height) > 90
    rows = dict(re.findall(r"<tr><th[^>]*>([^<]+)</th>(.*?)</tr>", html))
    assert re.findall(r">([^<]+)</td>", rows["vertices"]) == ["1,800", "300"] and "yes" in rows["verified"]


def test_texts_are_escaped_and_shortcomings_told():
    remeshed = sr.remesh(*torus(), points=200, max_error=1e-4)
    remeshed.notes.append("<script>")
    html = remeshed._repr_html_()
    assert "&lt;script&gt;" in html and "<script>" not in html
    assert "no: the distance to the input is up to" in html


def test_meshes_without_a_report_are_shown_too():
    assert "1,800" in sr.Mesh(*torus())._repr_html_()
    points = sr.sample(*torus(), points=300)
    assert "<img" not in points._repr_html_() and "300" in points._repr_html_()
    assert repr(points) == "<Sampled: 300 vertices, 0 faces>"
