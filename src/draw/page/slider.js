// A slider along each axis, with the regions behind the first one where it is alone.

class Slider {
  /** `move` takes the number of a stop. */
  constructor(element, data, axis, move) {
    this.axis = data.axes[axis];
    this.last = this.axis.values.length - 1;
    this.input = html("input", { type: "range", id: `axis${axis}`, min: 0, max: this.last, step: 1, value: 0 });
    this.output = html("output");
    this.output.htmlFor = this.input.id;
    this.name = html("span", { className: "name" });
    this.input.addEventListener("input", () => move(Number(this.input.value)));
    const label = html("label", { htmlFor: this.input.id }, `${this.axis.name} =`, this.output, this.name);
    element.append(html("div", { className: "axis" }, label, this.input, ...(data.axes.length > 1 ? [] : [this.track(data)])));
  }

  /** The regions in the order of the stops; a stop stands in the middle of its part. */
  track({ frames, regions }) {
    const track = html("div", { className: "track", ariaHidden: "true" });
    const part = (stop) => Math.min(100, Math.max(0, (100 * stop) / (this.last || 1)));
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

  /** Shows a stop, and what it is called; `words` are for those who do not see it. */
  show(stop, name, words) {
    this.input.value = stop;
    this.output.value = String(this.axis.values[stop]);
    this.name.textContent = name;
    this.input.setAttribute("aria-valuetext", `${this.output.value}, ${words}`);
  }
}
