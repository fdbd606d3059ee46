// What is shown of a mesh, and what is saved of a result.

const byId = (id) => document.getElementById(id);

let viewer = null;

// Sizes change on paper.
addEventListener("afterprint", () => viewer?.draw());

/** Shows a report; coloured as the one before it was, if that can be. */
export function show({ title, main, scene }) {
  const colouring = byId("report").querySelector("input[name=colouring]:checked")?.value;
  clear();
  byId("report").innerHTML = main;
  byId("heading").hidden = byId("lede").hidden = true;
  document.title = `${new DOMParser().parseFromString(title, "text/html").body.textContent} · remesh`;
  const choice = byId("report").querySelector(`input[name=colouring][value="${colouring}"]`);
  if (choice) choice.checked = true;
  // Of the scripts of viewer/, which are those of a report by itself, too.
  viewer = showReport(byId("report"), JSON.parse(scene));
  byId("report").dataset.viewer = viewer ? "ready" : "none";
}

/** Shows nothing any more. */
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
