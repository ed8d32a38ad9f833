// The four tabs of the panel. Arrow keys, Home and End go from tab to tab, as screen readers expect.

const tabs = [...document.querySelectorAll("[role=tab]")];
const panelOf = (tab) => document.getElementById(tab.getAttribute("aria-controls"));

function select(chosen) {
  for (const tab of tabs) {
    tab.setAttribute("aria-selected", tab === chosen);
    tab.tabIndex = tab === chosen ? 0 : -1;
    panelOf(tab).hidden = tab !== chosen;
  }
}

// Opens the tab with this control.
export function show(control) {
  const panel = control.closest("[role=tabpanel]");
  if (panel?.hidden) select(tabs.find((tab) => panelOf(tab) === panel));
}

export function listenToTabs(onChange) {
  for (const tab of tabs) {
    tab.addEventListener("click", () => {
      select(tab);
      onChange();
    });
    tab.addEventListener("keydown", (event) => {
      const { key, ctrlKey, altKey, metaKey } = event;
      const index = tabs.indexOf(tab), count = tabs.length;
      const next = { ArrowLeft: index - 1, ArrowRight: index + 1, Home: 0, End: count - 1 }[key];
      if (next === undefined || ctrlKey || altKey || metaKey) return;
      event.preventDefault();
      const chosen = tabs[(next + count) % count];
      select(chosen);
      chosen.focus();
      onChange();
    });
  }
}
