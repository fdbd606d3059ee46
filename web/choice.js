// Takes files: those dropped anywhere on the page, those chosen, or a model that comes with it.

const byId = (id) => document.getElementById(id);

/** Calls `take` with each list of files that is given. */
export function listenForFiles(take) {
  const taken = (files) => files.length && take([...files]);
  listenForDrops(taken);
  byId("choose").addEventListener("click", () => byId("files").click());
  byId("files").addEventListener("change", ({ target }) => {
    taken(target.files);
    // The same file can be chosen again.
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

/** A model that comes with the page; its content is fetched when it is read. */
async function model(name) {
  return new File([await (await fetch(`data/${name}`)).blob()], name);
}
