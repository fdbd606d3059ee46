"use strict";

// Meshes and edges on the graphics card.

/** Bytes of each corner of each triangle: place (6), distance, mark, angle, quality, the valences of all three, padding. */
const STRIDE = 16;

/** A mesh of a scene, ready to be drawn. */
function upload(gl, mesh) {
  const corners = numbers(mesh.corners, mesh.vertices > 65536 ? Uint32Array : Uint16Array);
  const faces = gl.createVertexArray();
  gl.bindVertexArray(faces);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, interleaved(mesh, corners), gl.STATIC_DRAW);
  attribute(gl, 0, 3, gl.UNSIGNED_SHORT, STRIDE, 0);
  attribute(gl, 1, 4, gl.UNSIGNED_BYTE, STRIDE, 6);
  gl.enableVertexAttribArray(2);
  gl.vertexAttribIPointer(2, 3, gl.UNSIGNED_BYTE, STRIDE, 10);
  return {
    faces,
    count: corners.length,
    hasDistance: mesh.distance !== null,
    sharp: uploadEdges(gl, mesh.sharp),
    leftOut: uploadEdges(gl, mesh.leftOut),
  };
}

/** All that is known at each corner: of its vertex, and of its face. */
function interleaved(mesh, corners) {
  const places = numbers(mesh.positions, Uint16Array);
  const [angle, quality, valence] = [mesh.angle, mesh.quality, mesh.valence].map((text) => numbers(text, Uint8Array));
  const distance = mesh.distance ? numbers(mesh.distance, Uint8Array) : new Uint8Array(mesh.vertices);
  const marked = new Set(mesh.marked);
  const data = new DataView(new ArrayBuffer(STRIDE * corners.length));
  for (let corner = 0; corner < corners.length; corner++) {
    const [at, face, v] = [STRIDE * corner, Math.floor(corner / 3), corners[corner]];
    for (let k = 0; k < 3; k++) {
      data.setUint16(at + 2 * k, places[3 * v + k], true);
      data.setUint8(at + 10 + k, valence[corners[3 * face + k]]);
    }
    data.setUint8(at + 6, distance[v]);
    data.setUint8(at + 7, marked.has(face) ? 255 : 0);
    data.setUint8(at + 8, angle[face]);
    data.setUint8(at + 9, quality[face]);
  }
  return data;
}

/** Edges by the places of their ends, drawn once for each. */
function uploadEdges(gl, text) {
  const ends = numbers(text, Uint8Array);
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, ends, gl.STATIC_DRAW);
  attribute(gl, 0, 3, gl.UNSIGNED_SHORT, 12, 0);
  attribute(gl, 1, 3, gl.UNSIGNED_SHORT, 12, 6);
  gl.vertexAttribDivisor(0, 1);
  gl.vertexAttribDivisor(1, 1);
  return { array, count: ends.length / 12 };
}

function attribute(gl, place, size, type, stride, offset) {
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, size, type, true, stride, offset);
}

/** Little-endian numbers that are spelled as base64. */
function numbers(base64, Kind) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new Kind(bytes.buffer);
}
