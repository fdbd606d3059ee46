// Shows reports on meshes, and saves results.

const byId = (id) => document.getElementById(id);

let viewer = null;

// Printing changes sizes, so the meshes are drawn again afterwards.
addEventListener("afterprint", () => viewer?.draw());

/** Shows a report, with the colouring of the previous one if it has that. */
export function show({ title, main, scene }) {
  const colouring = byId("report").querySelector("input[name=colouring]:checked")?.value;
  clear();
  byId("report").innerHTML = main;
  byId("heading").hidden = byId("lede").hidden = true;
  document.title = `${new DOMParser().parseFromString(title, "text/html").body.textContent} · remesh`;
  const choice = byId("report").querySelector(`input[name=colouring][value="${colouring}"]`);
  if (choice) choice.checked = true;
  // `showReport` comes from the scripts in viewer/, which stand-alone reports also use.
  viewer = showReport(byId("report"), JSON.parse(scene));
  byId("report").dataset.viewer = viewer ? "ready" : "none";
}

/** Removes the report. */
export function clear() {
  viewer?.dispose();
  viewer = null;
  byId("report").replaceChildren();
  delete byId("report").dataset.viewer;
}

/** Saves files. */
export function save({ names, files }) {
  names.forEach((name, i) => {
    const address = URL.createObjectURL(new Blob([files[i]]));
    const link = Object.assign(document.createElement("a"), { href: address, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  });
}
