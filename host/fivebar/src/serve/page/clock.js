// A timer for the page, in a worker. Browsers slow the timers of a hidden page to one a
// second or less, but not those of a worker. A page that hangs or is suspended gets no
// ticks, and so sends no signs of life.
const TICK = 50; // ms

setInterval(() => postMessage(null), TICK);
