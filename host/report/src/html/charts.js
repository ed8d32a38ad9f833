"use strict";
// Draws each chart of the page from the data in its script element. A drag zooms, a double click
// shows the whole chart again.
for (const figure of document.querySelectorAll("figure.chart:has(script)")) {
  const SHADES = 6, HEIGHT = 300, GREATEST = 560; // px
  const chart = JSON.parse(figure.querySelector("script").textContent);
  const series = chart.series.filter(({ x }) => x.length);
  const rises = series.every(({ x }) => x.every((value, i) => i === 0 || value > x[i - 1]));
  let plot;

  const colour = name => getComputedStyle(figure).getPropertyValue(name).trim();
  const text = value => value === null ? "" : String(Number(value.toPrecision(6))).replaceAll("-", "−");

  // Only powers of ten have a label, if two of them are in sight.
  function decades(plot, values) {
    const isPower = value => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
    const seen = values.filter(isPower).length;
    return seen < 2 ? values : values.map(value => isPower(value) ? value : null);
  }

  function axis(label, more) {
    const line = { stroke: colour("--grid"), width: 1 };
    return { label, stroke: colour("--ink"), grid: line, ticks: line, labelSize: 20, font: "13px system-ui",
      labelFont: "14px system-ui", values: (_, values) => values.map(text), ...more };
  }

  // Room for the longest number.
  const side = (_, values) => 14 + 7.5 * Math.max(2, ...(values ?? []).map(value => value.length));

  // A curve that is no function of x. The library's own paths take x in order.
  function curve(plot, index) {
    const stroke = new Path2D();
    uPlot.orient(plot, index, (_, xs, ys, scaleX, scaleY, toX, toY, left, top, width, height) => {
      let pen = "moveTo";
      xs.forEach((x, i) => {
        if (ys[i] !== null) stroke[pen](toX(x, scaleX, width, left), toY(ys[i], scaleY, height, top));
        pen = ys[i] === null ? "moveTo" : "lineTo";
      });
    });
    return { stroke };
  }

  // The series' own point nearest to the cursor: each series has values of x of its own.
  function nearest(plot, index, hovered) {
    const values = plot.data[index];
    for (let away = 0; away < values.length; away++) {
      const found = [hovered - away, hovered + away].find(i => values[i] !== undefined);
      if (found !== undefined) return found;
    }
  }

  // The least and greatest of some numbers, with a margin.
  function range(values, share) {
    const [low, high] = values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
    const margin = share * (high - low) || 0.5 * Math.max(Math.abs(low), 1);
    return [low - margin, high + margin];
  }
  const whole = {
    x: range(series.flatMap(({ x }) => x), chart.equal ? 0.04 : 0),
    y: range(series.flatMap(({ y }) => y).filter(value => value !== null), 0.05),
  };

  // Shows the whole of curves in the plane, if wanted with the same scale along both axes.
  function show(plot) {
    const pixels = { x: plot.bbox.width, y: plot.bbox.height };
    const per = Math.max(...["x", "y"].map(axis => (whole[axis][1] - whole[axis][0]) / pixels[axis]));
    for (const axis of ["x", "y"]) {
      const [low, high] = whole[axis];
      const half = 0.5 * (chart.equal ? per * pixels[axis] : high - low);
      plot.setScale(axis, { min: 0.5 * (low + high) - half, max: 0.5 * (low + high) + half });
    }
  }

  function draw() {
    plot?.destroy();
    const width = figure.clientWidth;
    const shape = (whole.y[1] - whole.y[0]) / (whole.x[1] - whole.x[0]);
    const options = {
      mode: rises ? 1 : 2,
      width,
      height: chart.equal ? Math.min(Math.max(shape * (width - 100) + 70, HEIGHT), GREATEST) : HEIGHT,
      scales: { x: { time: false, distr: chart.log ? 3 : 1 } },
      axes: [axis(chart.x, { filter: chart.log ? decades : undefined }), axis(chart.y, { size: chart.equal ? 60 : side })],
      series: [rises ? { label: chart.x, value: (_, value) => value === null ? "–" : text(value) } : null],
      legend: { live: rises, markers: { dash: (plot, index) => plot.series[index].dash ? "dashed" : "solid" } },
      // After the library has laid out the axes; within the hook it would drop the new scales.
      hooks: { ready: rises ? [] : [plot => queueMicrotask(() => show(plot))] },
      cursor: rises ? { dataIdx: nearest }
        : { drag: { x: true, y: true }, points: { show: false }, bind: { dblclick: plot => () => show(plot) } },
    };
    series.forEach(({ label, stroke }, index) => {
      const shade = colour(`--s${index % SHADES + 1}`), dots = stroke === "dots";
      options.series.push({ label, class: label ? undefined : "unnamed", stroke: shade, width: 1.5, dash: stroke === "dashed" ? [5, 4] : undefined,
        value: (_, value) => value === null ? "–" : text(value), points: { show: dots, size: 4, fill: shade },
        paths: dots ? () => null : rises ? undefined : curve, facets: [{ scale: "x" }, { scale: "y" }] });
    });
    const tables = series.map(({ x, y }) => [x, y]);
    plot = new uPlot(options, rises ? uPlot.join(tables) : [null, ...tables], figure);
    figure.plot = plot;
    const canvas = plot.ctx.canvas;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", figure.querySelector("b").textContent);
  }

  draw();
  new ResizeObserver(() => { if (plot.width !== figure.clientWidth) draw(); }).observe(figure);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}
