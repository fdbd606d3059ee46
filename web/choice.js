// Accepts files: dropped anywhere on the page, chosen in a dialog, or a model that comes with the page.

const byId = (id) => document.getElementById(id);

/** Calls `take` with each list of files that the user provides. */
export function listenForFiles(take) {
  const taken = (files) => files.length && take([...files]);
  listenForDrops(taken);
  byId("choose").addEventListener("click", () => byId("files").click());
  byId("files").addEventListener("change", ({ target }) => {
    taken(target.files);
    // Allows choosing the same file again.
    target.value = "";
  });
  for (const button of document.querySelectorAll("[data-model]")) {
    button.addEventListener("click", () => model(button.dataset.model).then((file) => taken([file])));
  }
}

function listenForDrops(taken) {
  const isOver = (over) => document.body.classList.toggle("over", over);
  addEventListener("dragover", (event) => {
    event.preventDefault();
    isOver(true);
  });
  addEventListener("dragleave", (event) => event.relatedTarget || isOver(false));
  addEventListener("drop", (event) => {
    event.preventDefault();
    isOver(false);
    taken(event.dataTransfer.files);
  });
}

/** Fetches a model that comes with the page. */
async function model(name) {
  return new File([await (await fetch(`data/${name}`)).blob()], name);
}
