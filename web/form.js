// The form. It is filled with the library's defaults, and returns the user's choices.

const byId = (id) => document.getElementById(id);

/** The field for the density under each way to specify it. */
const WAYS = {
  points: { label: "Number of vertices", min: 1, step: 1 },
  edge_length: { label: "Mean edge length", min: 0, step: "any", value: "" },
  max_error: { label: "Percent of the diagonal", min: 0, step: "any", value: "0.5" },
};

/** Fills the form from the library's description of itself. */
export function fillForm({ form, smoothing, read }) {
  WAYS.points.value = form.points;
  byId("features").value = form.features;
  byId("adapt").value = form.adapt;
  byId("smooth").append(new Option("if points are noisy", ""), new Option("no", 0), new Option("standard", smoothing), new Option("more", Math.ceil(1.5 * smoothing)));
  byId("smooth").value = form.smooth ?? "";
  byId("weld").value = form.weld ?? "";
  byId("fill_holes").value = form.fill_holes;
  byId("seed").value = form.seed;
  byId("attributes").checked = form.attributes;
  byId("format").append(...read.map(({ name, ending }) => new Option(name, ending)));
  byId("by").addEventListener("change", showWay);
  byId("density").addEventListener("input", () => (WAYS[byId("by").value].value = byId("density").value));
  byId("features").addEventListener("change", showAngle);
  byId("adapt").addEventListener("input", showGrading);
  showWay();
  showAngle();
  showGrading();
}

/** Returns the content of the form as `src/form.rs` expects it. */
export function readForm() {
  const value = (id) => byId(id).value;
  const number = (id) => (value(id) === "" ? null : Number(value(id)));
  const by = value("by");
  return {
    points: { points: value("density"), max_error: "auto" }[by] ?? null,
    edge_length: by === "edge_length" ? number("density") : null,
    max_error: by === "max_error" ? `${value("density")}%` : null,
    features: value("features") === "angle" ? value("angle") : value("features"),
    adapt: number("adapt"),
    smooth: number("smooth"),
    weld: number("weld"),
    fill_holes: number("fill_holes"),
    seed: number("seed"),
    attributes: byId("attributes").checked,
    format: value("format") || null,
  };
}

function showWay() {
  const { label, min, step, value } = WAYS[byId("by").value];
  byId("density-label").textContent = label;
  Object.assign(byId("density"), { min, step, value });
}

function showAngle() {
  const isAsked = byId("features").value === "angle";
  byId("angle-field").hidden = !isAsked;
  // A hidden field must not fail validation, since users cannot correct it.
  byId("angle").disabled = !isAsked;
}

function showGrading() {
  const { value } = byId("adapt");
  byId("adapt-told").textContent = Number(value) === 0 ? "(even)" : `(${value})`;
}
