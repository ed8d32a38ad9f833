// Files that the user opens or drops on the page. Of several, the first is loaded; the others wait for the next sheet.

const nextSheet = document.getElementById("next-sheet");
let waiting = []; // files

// The picture of a file as a data URI.
function pictureOf(file, type) {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result);
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(new Blob([file], { type }));
  });
}

// The text of a file; one that gzip has compressed, such as .svgz, is decompressed.
async function textOf(file) {
  const [first, second] = new Uint8Array(await file.slice(0, 2).arrayBuffer());
  if (first === 0x89 && second === 0x50) return pictureOf(file, "image/png");
  if (first === 0xff && second === 0xd8) return pictureOf(file, "image/jpeg");
  if (first !== 0x1f || second !== 0x8b) return file.text();
  return new Response(file.stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

function showWaiting() {
  nextSheet.hidden = waiting.length === 0;
  if (waiting.length > 0) nextSheet.textContent = `Next sheet: ${waiting[0].name} (${waiting.length} left)`;
}

// Listens to the input of files, to drops and to the button of the next sheet, which only loads: the user runs each job.
// `load` gets name and text; `refuse` gets a sentence.
export function listenToFiles(input, connection, load, refuse) {
  const open = async (file) => { if (file) load(file.name, await textOf(file)); };
  const openAll = (files) => {
    const [first, ...others] = files;
    if (!first) return;
    waiting = others;
    showWaiting();
    open(first);
  };
  input.onchange = () => openAll(input.files);
  nextSheet.onclick = () => {
    if (connection.mayMove) {
      refuse("Not now: the arm moves. Wait until the job has ended, or stop it.");
      return;
    }
    open(waiting.shift());
    showWaiting();
  };
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
    else openAll(event.dataTransfer.files);
  });
}
