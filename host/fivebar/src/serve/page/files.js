// Files that the user opens or drops on the page.

// The text of a file; one that gzip has compressed, such as .svgz, is decompressed.
async function textOf(file) {
  const [first, second] = new Uint8Array(await file.slice(0, 2).arrayBuffer());
  if (first !== 0x1f || second !== 0x8b) return file.text();
  return new Response(file.stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

// Listens to the input of files and to drops. `load` gets name and text; `refuse` gets a sentence.
export function listenToFiles(input, connection, load, refuse) {
  const open = async (file) => { if (file) load(file.name, await textOf(file)); };
  input.onchange = () => open(input.files[0]);
  // While the browser's window to choose a file is open, it takes the keys.
  input.onclick = (event) => {
    if (!connection.mayMove) return;
    event.preventDefault();
    refuse("Not now: the arm moves, and the window to choose a file would take the keys that stop it.");
  };
  input.oncancel = () => {
    if (connection.mayMove) connection.emergencyStop();
  };
  const mark = (on) => document.body.classList.toggle("drops", on);
  // Without this a browser leaves the page and shows the dropped file.
  addEventListener("dragover", (event) => {
    event.preventDefault();
    mark(true);
  });
  addEventListener("dragleave", ({ relatedTarget }) => { if (!relatedTarget) mark(false); });
  addEventListener("drop", (event) => {
    event.preventDefault();
    mark(false);
    if (connection.mayMove) refuse("Not now: the arm moves. Stop it, then drop the file again.");
    else open(event.dataTransfer.files[0]);
  });
}
