"use strict";

// Small vectors and matrices; a matrix is a list of its rows.

function norm(v) {
  return Math.hypot(...v);
}

function minus(a, b) {
  return a.map((x, i) => x - b[i]);
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(v) {
  const length = norm(v) || 1;
  return v.map((x) => x / length);
}

function times(rows, v) {
  return rows.map((row) => dot(row, v));
}

function product(a, b) {
  return a.map((row) => [0, 1, 2].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k]));
}

/** A rotation without what rounding added to it. */
function orthonormal([right, , near]) {
  const z = unit(near);
  const y = unit(cross(z, right));
  return [cross(y, z), y, z];
}

/** The rotation that looks against `normal`, with `up` as upright as can be. */
function facing(normal, up) {
  const z = unit(normal);
  const side = cross(up, z);
  const x = norm(side) > 1e-3 ? unit(side) : unit(cross(Math.abs(z[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], z));
  return [x, cross(z, x), z];
}
