// A colour of the style sheet, by its name there: light or dark as the page is.
export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(name).trim();
