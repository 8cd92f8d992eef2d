// A slider for each axis, and buttons. If there is only one slider, the regions are behind it.

/** Returns the stop whose value is nearest. */
function nearest(values, value) {
  return values.reduce((best, at, stop) => (Math.abs(at - value) < Math.abs(values[best] - value) ? stop : best), 0);
}

/** Returns the number of digits that distinguish most neighbors. */
function apart(values) {
  const gaps = values.slice(1).map((value, at) => Math.abs(value - values[at])).filter((gap) => gap > 0).sort((a, b) => a - b);
  const most = Math.max(...values.map(Math.abs));
  const digits = gaps.length > 0 ? Math.floor(Math.log10(most)) - Math.floor(Math.log10(gaps[gaps.length >> 1])) + 2 : 0;
  return Math.min(15, Math.max(4, digits));
}

/** Returns the first stop beyond the next border, or the last stop; `regions` has the region of each stop. */
function border(regions, stop, way) {
  const next = (at) => at + way >= 0 && at + way < regions.length;
  let at = stop;
  while (next(at)) {
    at += way;
    if (regions[at] !== regions[stop]) break;
  }
  return at;
}

/** How long a stop is shown while the page plays [ms]. */
const STILL = 90;

/** Returns buttons for the actions of keys, and one that plays; at the end, `again` goes back to the start. */
function buttons({ step, border, again }) {
  let playing = null;
  const button = (sign, words, act) => html("button", { type: "button", ariaLabel: words, title: words, onclick: act }, sign);
  const stop = () => {
    clearInterval(playing);
    playing = null;
    Object.assign(play, { textContent: "▶", ariaLabel: "Play", title: "Play" });
  };
  const play = button("▶", "Play", () => {
    if (playing !== null) return stop();
    Object.assign(play, { textContent: "II", ariaLabel: "Pause", title: "Pause" });
    playing = setInterval(() => (play.isConnected ? again() || step(1) : stop()), STILL);
  });
  return html("div", { className: "buttons" }, button("«", "Border before", () => border(-1)), button("‹", "One step back", () => step(-1)),
    play, button("›", "One step on", () => step(1)), button("»", "Next border", () => border(1)));
}

class Slider {
  /** `move` takes the index of a stop. */
  constructor(element, data, axis, move) {
    this.axis = data.axes[axis];
    this.words = (value) => (Number.isInteger(value) ? String(value).replace("-", "−") : digits(value, apart(this.axis.values)));
    this.move = move;
    this.last = this.axis.values.length - 1;
    this.input = html("input", { type: "range", id: `axis${axis}`, min: 0, max: this.last, step: 1, value: 0 });
    this.output = html("output");
    this.output.htmlFor = this.input.id;
    this.name = html("span", { className: "name" });
    this.input.addEventListener("input", () => move(Number(this.input.value)));
    const label = html("label", { htmlFor: this.input.id }, `${this.axis.name} =`, this.output, this.name);
    element.append(html("div", { className: "axis" }, label, this.input, ...(data.axes.length > 1 ? [] : [this.track(data)])));
  }

  /** Returns the track with the regions of the stops; each stop is in the middle of its part. */
  track({ frames, regions }) {
    const track = html("div", { className: "track", ariaHidden: "true" });
    track.addEventListener("click", ({ clientX }) => {
      const { left, width } = track.getBoundingClientRect();
      this.move(Math.round(((clientX - left) / width) * this.last));
    });
    const part = (stop) => Math.min(100, Math.max(0, (100 * stop) / (this.last || 0.5)));
    for (let from = 0, to; from < frames.length; from = to) {
      for (to = from + 1; to < frames.length && frames[to].region === frames[from].region; ) to += 1;
      const { name, fill } = regions[frames[from].region] ?? { name: "", fill: "#ffffff" };
      const [left, right] = [part(from - 0.5), part(to - 0.5)];
      const span = html("span", {}, 12 * (right - left) > name.length * 8 ? name : "");
      Object.assign(span.style, { left: `${left}%`, width: `${right - left}%`, background: fill });
      track.append(span);
    }
    return track;
  }

  /** Shows words in place of a value, with the slider at its end. */
  none(words) {
    this.input.value = this.last;
    this.output.value = words;
    delete this.output.dataset.value;
    this.name.textContent = "";
    this.input.setAttribute("aria-valuetext", words);
  }

  /** Shows a stop and its name; `words` are for screen readers. A `value` may lie between stops. */
  show(stop, name, words, value = this.axis.values[stop]) {
    this.input.value = stop;
    this.output.value = this.words(value);
    this.output.dataset.value = value;
    this.name.textContent = name;
    this.input.setAttribute("aria-valuetext", `${this.output.value}, ${words}`);
  }
}
