// A colour of the style sheet by its name, in the page's light or dark scheme.
export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(name).trim();
