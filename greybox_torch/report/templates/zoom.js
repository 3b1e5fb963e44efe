// Time ranges of the traces: dragged over a curve, or moved with the buttons; the same for all charts of an experiment.
// Without this script the page shows the whole records. Nothing is fetched: the samples stand in the page.
(function () {
  "use strict";
  const WIDTH = 2000, HEIGHT = 1000, COLUMNS = 700, MOST_TICKS = 6, SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";

  function unpacked(packed) {
    const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
    const steps = new DataView(bytes.buffer), values = new Float64Array(bytes.length / 2);
    for (let k = 0; k < values.length; k++) {
      const step = steps.getUint16(2 * k, true);
      values[k] = step === 65535 ? NaN : packed.low + (packed.reach * step) / 65534;
    }
    return values;
  }

  function read(element) {
    const told = JSON.parse(element.textContent), series = {};
    for (const name in told.series) series[name] = unpacked(told.series[name]);
    const clock = told.clock ? unpacked(told.clock) : null;
    const at = (k) => (clock ? clock[Math.min(k, clock.length - 1)] : told.time[0] + k * told.step);
    return { experiment: String(told.experiment), first: told.time[0], last: told.time[1], each: told.paired ? 2 : 1, series, at };
  }

  // Round values within an axis, as on the picture without a script.
  function ticks(low, high, most) {
    const size = Math.pow(10, Math.floor(Math.log10((high - low) / most)));
    let values = [];
    for (const factor of [1, 2, 5, 10]) {
      const step = factor * size, first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
      values = Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
      if (last - first <= most) break;
    }
    return values;
  }

  function labels(values) {
    const step = values.length > 1 ? Math.abs(values[1] - values[0]) : Math.abs(values[0]) || 1;
    const largest = Math.max(...values.map(Math.abs), 0), digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const minus = (text) => text.replace(/^-(0(?:\.0*)?)$/, "$1").replace("-", "−");
    if (digits <= 4 && largest < 1e5) return values.map((v) => minus(v.toFixed(digits)));
    const power = Math.floor(Math.log10(largest)), more = Math.min(20, Math.max(0, power - Math.floor(Math.log10(step) + 1e-9)));
    const raised = String(power).replace("-", "⁻").replace(/\d/g, (d) => SUPERSCRIPT[d]);
    return values.map((v) => (v === 0 ? "0" : minus((v / Math.pow(10, power)).toFixed(more)) + "×10" + raised));
  }

  function written(holder, values, low, high, side) {
    const texts = labels(values);
    holder.replaceChildren(
      ...values.map((value, k) => {
        const label = document.createElement("span");
        label.style[side] = ((100 * (value - low)) / (high - low)).toFixed(2) + "%";
        label.textContent = texts[k];
        return label;
      })
    );
  }

  // The first and the last stretch of a series within [begin, end], and one more on either side.
  function within(samples, values, begin, end) {
    const count = values.length / samples.each;
    const search = (time) => {
      let low = 0, high = count;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (samples.at(middle) < time) low = middle + 1;
        else high = middle;
      }
      return low;
    };
    return [Math.max(0, search(begin) - 1), Math.min(count - 1, search(end))];
  }

  function drawn(samples, values, begin, end, low, high, held) {
    const [first, last] = within(samples, values, begin, end), parts = [];
    const across = (time) => Math.round(WIDTH * Math.min(2, Math.max(-1, (time - begin) / (end - begin))));
    const up = (value) => Math.round(HEIGHT * (1 - Math.min(2, Math.max(-1, (value - low) / (high - low)))));
    const stretch = Math.max(1, Math.ceil((last - first + 1) / COLUMNS));
    const steps = held && stretch === 1 && samples.each === 1; // every value until the next
    let down = false, before = 0;
    const point = (time, value) => {
      if (steps && down) parts.push("L" + across(time) + " " + before);
      if (Number.isFinite(value)) parts.push((down ? "L" : "M") + across(time) + " " + (before = up(value)));
      down = Number.isFinite(value);
    };
    for (let k = first; k <= last; k += stretch) {
      const part = values.subarray(k * samples.each, Math.min(last + 1, k + stretch) * samples.each);
      if (part.length === 1) {
        point(samples.at(k), part[0]);
        continue;
      }
      let least = Infinity, most = -Infinity;
      for (const value of part) {
        if (value < least) least = value;
        if (value > most) most = value;
      }
      point(samples.at(k), least);
      point(samples.at(Math.min(last, k + stretch / 2)), most);
    }
    return parts.join("");
  }

  function heights(panel, samples, begin, end) {
    let low = panel.zero ? 0 : Infinity, high = panel.zero ? 0 : -Infinity;
    for (const { name } of panel.lines) {
      const values = samples.series[name], [first, last] = within(samples, values, begin, end);
      for (let k = first * samples.each; k < (last + 1) * samples.each; k++) {
        if (!Number.isFinite(values[k])) continue;
        const value = Math.min(panel.clip[1], Math.max(panel.clip[0], values[k]));
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (!(high >= low)) return [0, 1];
    const spare = high > low ? 0.06 * (high - low) : Math.max(0.1 * Math.abs(high), 1e-12);
    return [low - spare, high + spare];
  }

  function redraw(panel, samples, begin, end) {
    const [low, high] = heights(panel, samples, begin, end);
    for (const { path, name } of panel.lines) path.setAttribute("d", drawn(samples, samples.series[name], begin, end, low, high, panel.held));
    const x = ticks(begin, end, MOST_TICKS), y = ticks(low, high, panel.ticks);
    const level = (value) => Math.round(HEIGHT * (1 - (value - low) / (high - low)));
    const place = (time) => Math.round((WIDTH * (time - begin)) / (end - begin));
    panel.grid.setAttribute("d", y.map((v) => `M0 ${level(v)}H${WIDTH}`).join("") + x.map((v) => `M${place(v)} 0V${HEIGHT}`).join(""));
    if (panel.line) panel.line.setAttribute("d", `M0 ${level(0)}H${WIDTH}`);
    if (panel.detail) {
      const [a, b] = panel.span.map((time) => Math.min(WIDTH, Math.max(0, place(time))));
      panel.detail.setAttribute("d", `M${a} 0H${b}V${HEIGHT}H${a}Z`);
    }
    written(panel.root.querySelector(".x-ticks"), x, begin, end, "left");
    written(panel.root.querySelector(".y-ticks"), y, low, high, "bottom");
  }

  const experiments = new Map();
  document.querySelectorAll("script.samples").forEach((element) => {
    const samples = read(element), figure = element.closest("figure");
    const shared = experiments.get(samples.experiment) || { panels: [], begin: samples.first, end: samples.last, first: samples.first, last: samples.last, bars: [] };
    experiments.set(samples.experiment, shared);
    figure.querySelectorAll(".panel[data-lines]").forEach((root) => {
      const numbers = (text) => (text || "").split(" ").map(Number);
      const lines = root.dataset.lines.split(" ").map((pair) => {
        const [series, name] = pair.split(":");
        return { path: root.querySelector("path.line." + series), name };
      });
      const panel = {
        root, lines, clip: numbers(root.dataset.clip), zero: root.dataset.zero === "1", held: root.dataset.held === "1", ticks: Number(root.dataset.ticks),
        grid: root.querySelector("path.grid"), line: root.querySelector("path.zero"), detail: root.querySelector("path.detail"),
        span: numbers(root.dataset.span), title: root.querySelector(".panel-title"),
      };
      shared.panels.push({ panel, samples });
      draggable(root.querySelector(".plot"), samples.experiment);
    });
    figure.insertBefore(toolbar(shared, samples.experiment), figure.querySelector(".columns"));
  });

  function show(experiment, begin, end) {
    const shared = experiments.get(experiment);
    if (!shared || !(end > begin)) return;
    const least = 1e-6 * (shared.last - shared.first), length = Math.max(end - begin, least);
    const from = Math.min(Math.max(begin, shared.first), shared.last - Math.min(length, shared.last - shared.first));
    shared.begin = from;
    shared.end = Math.min(from + length, shared.last);
    for (const { panel, samples } of shared.panels) redraw(panel, samples, shared.begin, shared.end);
    const whole = shared.begin <= shared.first && shared.end >= shared.last;
    for (const { panel } of shared.panels) if (panel.title) panel.title.textContent = whole ? "whole record" : "closer";
    for (const bar of shared.bars) {
      bar.querySelector("output").textContent = whole ? "" : `${shared.begin.toPrecision(5)} to ${shared.end.toPrecision(5)} s`;
      bar.querySelectorAll("button.closer").forEach((button) => (button.disabled = whole));
    }
  }

  function toolbar(shared, experiment) {
    const bar = document.createElement("p"), hint = document.createElement("span"), told = document.createElement("output");
    bar.className = "zoom";
    hint.textContent = "Drag over a curve to look closer.";
    const moves = [
      ["+", "Closer", false, (b, e) => [b + (e - b) / 4, e - (e - b) / 4]],
      ["−", "Farther", true, (b, e) => [b - (e - b) / 2, e + (e - b) / 2]],
      ["←", "Earlier", true, (b, e) => [b - (e - b) / 2, e - (e - b) / 2]],
      ["→", "Later", true, (b, e) => [b + (e - b) / 2, e + (e - b) / 2]],
      ["Whole record", "Whole record", true, () => [shared.first, shared.last]],
    ];
    bar.append(hint);
    for (const [text, name, closer, move] of moves) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = text;
      button.title = name;
      button.setAttribute("aria-label", name);
      if (closer) button.className = "closer";
      button.disabled = closer;
      button.addEventListener("click", () => show(experiment, ...move(shared.begin, shared.end)));
      bar.append(button);
    }
    bar.append(told);
    shared.bars.push(bar);
    return bar;
  }

  function draggable(plot, experiment) {
    let from = null, area = null;
    const share = (event) => {
      const box = plot.getBoundingClientRect();
      return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    };
    plot.classList.add("live");
    plot.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      from = share(event);
      area = document.createElement("span");
      area.className = "chosen-time";
      plot.append(area);
      if (event.isTrusted) plot.setPointerCapture(event.pointerId);
    });
    plot.addEventListener("pointermove", (event) => {
      if (from === null) return;
      const to = share(event);
      area.style.left = 100 * Math.min(from, to) + "%";
      area.style.width = 100 * Math.abs(to - from) + "%";
    });
    const ended = (event, taken) => {
      if (from === null) return;
      const to = share(event), { begin, end } = experiments.get(experiment), length = end - begin;
      area.remove();
      if (taken && Math.abs(to - from) > 0.01) show(experiment, begin + Math.min(from, to) * length, begin + Math.max(from, to) * length);
      from = null;
    };
    plot.addEventListener("pointerup", (event) => ended(event, true));
    plot.addEventListener("pointercancel", (event) => ended(event, false));
    plot.addEventListener("dblclick", () => {
      const shared = experiments.get(experiment);
      show(experiment, shared.first, shared.last);
    });
  }

  // An address that ends with #time=EXPERIMENT,BEGIN,END shows that stretch: something to send to a colleague.
  function addressed() {
    const found = /^#time=(\d+),([-+.\deE]+),([-+.\deE]+)$/.exec(decodeURIComponent(location.hash));
    if (found) show(found[1], Number(found[2]), Number(found[3]));
  }
  addEventListener("hashchange", addressed);
  addressed();
})();
