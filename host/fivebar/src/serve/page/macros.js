// The buttons of the robot file's macros.

// Makes a button for each name.
export function showMacros(names) {
  document.getElementById("macros").hidden = names.length === 0;
  document.getElementById("macro-buttons").replaceChildren(...names.map((name) => {
    const button = document.createElement("button");
    button.dataset.macro = name;
    button.textContent = name;
    return button;
  }));
}
