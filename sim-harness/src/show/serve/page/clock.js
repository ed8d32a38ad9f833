// Ticks for the page. The timers of a page that is hidden are slowed to one a second or
// less; a worker's go on. A page that hangs or is put to sleep hears none, as it should be.
const TICK = 50; // ms

setInterval(() => postMessage(null), TICK);
