"use strict";

// The camera that shows all meshes. Lengths are in half diagonals of the box of all meshes, from its middle.

/** Distance of the eye from what it looks at; the library's pictures have the same. */
const EYE = 5;

const LEAST_ZOOM = 0.3;
const MOST_ZOOM = 400;

/** How many times the length of the edges at a place is half of the height of what is seen of it. */
const EDGES_SEEN = 8;

/** A camera that sees `scene` at first as that says, and calls `changed` when it moves. */
function createCamera(scene, changed) {
  const first = { zoom: scene.zoom, target: scene.target, rotation: scene.rotation };
  const camera = { ...first };

  function set(values) {
    Object.assign(camera, values);
    changed();
  }

  function zoomTo(zoom) {
    return Math.min(Math.max(zoom, LEAST_ZOOM), MOST_ZOOM);
  }

  return {
    zoom: () => camera.zoom,

    reset: () => set(first),

    zoomBy: (factor) => set({ zoom: zoomTo(camera.zoom * factor) }),

    /** Turns what is seen about the axes of the screen, by radians. */
    turn(right, down) {
      const [sx, cx, sy, cy] = [Math.sin(down), Math.cos(down), Math.sin(right), Math.cos(right)];
      const about = [[cy, 0, sy], [sx * sy, cx, -sx * cy], [-cx * sy, sx, cx * cy]];
      set({ rotation: orthonormal(product(about, camera.rotation)) });
    },

    /** Moves what is seen, by shares of the height of a panel. */
    move(right, up) {
      const [x, y] = camera.rotation;
      set({ target: camera.target.map((t, i) => t - (2 / camera.zoom) * (right * x[i] + up * y[i])) });
    },

    /** Looks at a place from where its surface faces, near enough to see its edges. */
    lookAt({ point, normal, size }) {
      const rotation = norm(normal) > 0.5 ? facing(normal, scene.rotation[1]) : camera.rotation;
      set({ target: point, rotation, zoom: zoomTo(Math.max(1 / (EDGES_SEEN * size), 1.5)) });
    },

    /** What the shaders need to know for a panel of that size. */
    uniforms(width, height) {
      const lens = EYE * camera.zoom;
      return {
        target: camera.target,
        rotation: camera.rotation.flat(),
        lens: [(lens * height) / width, lens, EYE, 2.2 + norm(camera.target)],
      };
    },

    /** Where a point is on a panel of that size, from its upper left corner. */
    project(point, width, height) {
      const [right, up, near] = times(camera.rotation, minus(point, camera.target));
      const scale = (0.5 * height * EYE * camera.zoom) / (EYE - near);
      return [0.5 * width + scale * right, 0.5 * height - scale * up];
    },
  };
}
