// Pictures of many strokes. Each is painted once for a view, a part of it in each frame, so that a frame costs
// little however long the job is. While the view changes, the picture before is shown scaled and moved.

const POINTS = 400; // painted in one frame

// Points of strokes in a row: places [m], whether the point ends a line that the one before begins, and a kind.
export class Points {
  #size = 1024;
  #x = new Float64Array(this.#size);
  #y = new Float64Array(this.#size);
  #kind = new Int16Array(this.#size);
  length = 0;

  // A negative kind begins a stroke; the others are those of the line to the point.
  add([x, y], kind) {
    if (this.length === this.#size) {
      this.#size *= 2;
      const larger = (Type, old) => { const all = new Type(this.#size); all.set(old); return all; };
      this.#x = larger(Float64Array, this.#x);
      this.#y = larger(Float64Array, this.#y);
      this.#kind = larger(Int16Array, this.#kind);
    }
    this.#x[this.length] = x;
    this.#y[this.length] = y;
    this.#kind[this.length] = kind;
    this.length += 1;
  }

  // Draws the lines to the points from one number to another; `style` gives colour and width of a kind, or null for
  // kinds that are not drawn. Points that lie within half a pixel of the one before are left out.
  stroke(context, { scale, left, top }, from, to, style) {
    const pixel = (i) => [left + scale * this.#x[i], top - scale * this.#y[i]];
    let before = null, last = -1, endX = 0, endY = 0;
    for (let i = Math.max(1, from); i < to; i += 1) {
      const kind = this.#kind[i], wanted = kind < 0 ? null : style(kind);
      if (!wanted) continue;
      if (kind !== before) {
        if (before !== null) context.stroke();
        [context.strokeStyle, context.lineWidth] = wanted;
        context.beginPath();
      }
      if (kind !== before || last !== i - 1) {
        [endX, endY] = pixel(i - 1);
        context.moveTo(endX, endY);
      }
      const [x, y] = pixel(i);
      const goesOn = i + 1 < to && this.#kind[i + 1] === kind;
      if (!goesOn || Math.abs(x - endX) + Math.abs(y - endY) > 0.5) {
        context.lineTo(x, y);
        [endX, endY] = [x, y];
      }
      [before, last] = [kind, i];
    }
    if (before !== null) context.stroke();
  }

  // The number of the point that is nearest to a place [m]; null if none is within `radius` [m].
  nearest([x, y], radius) {
    let [found, least] = [null, radius * radius];
    for (let i = 0; i < this.length; i += 1) {
      const square = (this.#x[i] - x) ** 2 + (this.#y[i] - y) ** 2;
      if (square <= least) [found, least] = [i, square];
    }
    return found;
  }

  // Drops all points but the last `count`.
  keep(count) {
    const start = this.length - count;
    for (const all of [this.#x, this.#y, this.#kind]) all.copyWithin(0, start, this.length);
    this.#kind[0] = -1;
    this.length = count;
  }
}

export class Layer {
  #whole = null; // the last picture that was finished: its canvas, view and content
  #next = null; // the one that is painted
  #spare = null; // a canvas that no picture uses
  #painted = 0; // the number of its steps that are painted

  // Draws the picture of a content for a view; `paint(context, from, to)` paints some of its `count` steps. Returns
  // whether the picture is finished; more steps may be added to its end; with fewer steps it begins anew.
  draw(target, view, content, count, paint) {
    const wanted = [view.scale, view.left, view.top, view.width, view.height, view.ratio].join();
    if (this.#next?.wanted !== wanted || this.#next.content !== content || count < this.#painted) {
      if (this.#next && this.#next !== this.#whole) this.#spare = this.#next.canvas;
      const canvas = this.#spare ?? document.createElement("canvas");
      this.#spare = null;
      canvas.width = Math.round(view.width * view.ratio);
      canvas.height = Math.round(view.height * view.ratio);
      const context = canvas.getContext("2d");
      context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
      context.lineCap = context.lineJoin = "round";
      this.#next = { canvas, context, view, wanted, content };
      this.#painted = 0;
    }
    const end = Math.min(count, this.#painted + POINTS);
    if (end > this.#painted) paint(this.#next.context, this.#painted, end);
    this.#painted = end;
    if (end === count && this.#whole !== this.#next) {
      this.#spare = this.#whole?.canvas ?? null;
      this.#whole = this.#next;
    }
    const shown = this.#whole?.content === content ? this.#whole : this.#next;
    const share = view.scale / shown.view.scale;
    target.drawImage(shown.canvas, view.left - share * shown.view.left, view.top - share * shown.view.top,
      share * shown.view.width, share * shown.view.height);
    return end === count;
  }
}
