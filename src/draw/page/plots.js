// The plots, with a cursor in each of their panels.

class Plots {
  /** `place` takes the point of a click, in values of the axes. */
  constructor(element, data, place) {
    this.data = data;
    this.picture = element.querySelector("svg");
    this.cursors = [];
    if (!this.picture) return;
    this.picture.removeAttribute("width");
    this.picture.removeAttribute("height");
    this.cursors = data.windows.map((window) => this.cursor(window));
    this.picture.append(...this.cursors.flatMap((cursor) => cursor.lines));
    const pick = (event) => {
      if (event.buttons !== 1) return;
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.picture.getScreenCTM().inverse());
      const inside = ({ corner: [x, y], size: [w, h] }) => x <= point.x && point.x <= x + w && y <= point.y && point.y <= y + h;
      const window = data.windows.find(inside);
      if (window) place([value(window, 0, point.x), value(window, 1, point.y)]);
    };
    this.picture.addEventListener("pointerdown", pick);
    this.picture.addEventListener("pointermove", pick);
  }

  cursor(window) {
    const lines = [svg("line", { class: "cursor" })];
    if (this.data.axes.length > 1) lines.push(svg("line", { class: "cursor" }), svg("circle", { class: "cursor dot", r: 5 }));
    return { window, lines };
  }

  hide() {
    for (const line of this.cursors.flatMap(({ lines }) => lines)) line.style.display = "none";
  }

  /** Moves the cursors to these values of the axes. */
  show(values) {
    for (const { window, lines } of this.cursors) {
      for (const line of lines) line.style.display = "";
      const [upright, level, dot] = lines;
      const { corner: [left, top], size: [width, height] } = window;
      const x = pixel(window, 0, values[0]);
      set(upright, { x1: x, x2: x, y1: top, y2: top + height });
      if (!level) continue;
      const y = pixel(window, 1, values[1]);
      set(level, { x1: left, x2: left + width, y1: y, y2: y });
      set(dot, { cx: x, cy: y });
    }
  }
}

function set(element, attributes) {
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, Number(value.toFixed(2)));
}

/** Returns the pixel of a value of the x axis (0) or the y axis (1), which points up. */
function pixel(window, axis, value) {
  const [from, to] = axis ? window.y : window.x;
  const part = (value - from) / (to - from);
  return window.corner[axis] + window.size[axis] * (axis ? 1 - part : part);
}

/** Returns the value at a pixel. */
function value(window, axis, at) {
  const [from, to] = axis ? window.y : window.x;
  const part = (at - window.corner[axis]) / window.size[axis];
  return from + (to - from) * (axis ? 1 - part : part);
}
