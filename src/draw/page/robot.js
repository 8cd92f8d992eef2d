// The robot in its pose, with an arrow for each impulse and velocity, or force and acceleration.

/** Creates an SVG element with these attributes. */
function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** Creates an HTML element with these properties. */
function html(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/** Returns the greatest of ..., 1, 2, 5, 10, ... that is not above `most`. */
function round(most) {
  const unit = 10 ** Math.floor(Math.log10(most));
  return unit * [5, 2, 1].find((times) => times * unit <= most * (1 + 1e-9));
}

/** Returns an arrow on the screen with its tip at `to`. */
function arrow(kind, from, to) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (!(length > 0.5)) return svg("g");
  const [ux, uy] = [dx / length, dy / length];
  const head = Math.min(/^(impulse|in-loop)/.test(kind) ? 12 : 10, length);
  const neck = [to[0] - head * ux, to[1] - head * uy];
  const half = 0.38 * head;
  const corners = [to, [neck[0] - half * uy, neck[1] + half * ux], [neck[0] + half * uy, neck[1] - half * ux]];
  return svg("g", { class: `arrow ${kind}` },
    svg("line", { x1: from[0], y1: from[1], x2: neck[0], y2: neck[1] }),
    svg("polygon", { class: "head", points: corners.map((corner) => corner.join(",")).join(" ") }));
}

/** Draws frames into an SVG element, all on one scale. A unit of the SVG is a pixel of the screen. */
class Robot {
  /** Shares of the drawing's height: the usual and the greatest length of an arrow. */
  static USUAL = 0.24;
  static LONGEST = 0.48;
  /** Shares of the drawing's height that are free on each side of the robot, above and below. */
  static ROOM = { side: 0.18, above: 0.06, below: 0.2 };
  /** A velocity before is ASIDE [px] aside if the sine of its angle to another arrow or the ground is below ALONG. */
  static ALONG = 0.15;
  static ASIDE = 12;
  /** A velocity after whose arrow is shorter than this is also shown as a direction [px]. */
  static SEEN = 4;

  constructor(element, key, data) {
    this.element = element;
    this.legend = key;
    this.data = data;
    this.shown = [data.frames[0], null];
    new ResizeObserver(() => this.fit()).observe(element);
    this.fit();
  }

  /** Adapts the drawing to the size of the element on the screen. */
  fit() {
    const [width, height] = [this.element.clientWidth || 620, this.element.clientHeight || 400];
    this.element.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const { low, high, impulse, velocity, before } = this.data.scale;
    const { side, above, below } = Robot.ROOM;
    const fits = [(width - 2 * side * height) / (high[0] - low[0]), (height * (1 - above - below)) / (high[1] - low[1])];
    this.zoom = Math.min(...fits.filter(Number.isFinite));
    if (!Number.isFinite(this.zoom)) this.zoom = height;
    this.middle = [width / 2, (height * (1 + above - below)) / 2];
    const usual = (value) => (Robot.USUAL * height) / value;
    this.length = { impulse: usual(impulse), velocity: usual(velocity), before: usual(before) };
    this.longest = Robot.LONGEST * height;
    this.key();
    this.show(...this.shown);
  }

  /** Shows a frame; `chosen` is the index of an outcome, or null for all. */
  show(frame, chosen) {
    this.shown = [frame, chosen];
    this.element.replaceChildren();
    const { pose } = frame;
    if (!pose) {
      const text = svg("text", { class: "refusal", x: "50%", y: "50%", "text-anchor": "middle" }, "This state is refused.");
      this.element.append(text);
      return;
    }
    const { low, high, follows } = this.data.scale;
    const center = [0, 1].map((axis) => (low[axis] + high[axis]) / 2 + (follows[axis] ? pose.middle[axis] : 0));
    this.at = ([x, z]) => [this.middle[0] + (x - center[0]) * this.zoom, this.middle[1] - (z - center[1]) * this.zoom];
    this.element.append(...this.ground(pose.ground, pose.profile), ...pose.bodies.map((body, at) => this.part(body, at)), ...this.skeleton(pose), ...this.contacts(frame, chosen));
  }

  /** Returns the ground; a slope continues on both sides. */
  ground(surface, isProfile) {
    if (surface.length < 2) return [];
    const points = surface.map(this.at);
    if (!isProfile) {
      const [[x0, y0], [x1, y1]] = points;
      const slope = (y1 - y0) / (x1 - x0);
      points.splice(0, 2, ...[-1000, 4000].map((x) => [x, y0 + slope * (x - x0)]));
    }
    const line = points.map((point) => point.join(",")).join(" ");
    const depth = Math.max(...points.map((point) => point[1]), 0) + 3000;
    const soil = `${points[0][0]},${depth} ${line} ${points.at(-1)[0]},${depth}`;
    return [svg("polygon", { class: "soil", points: soil }), svg("polyline", { class: "surface", points: line })];
  }

  /** Returns the collision shapes and the CoG of a body. */
  part([number, x, z, cos, sin], at) {
    const { outlines, com, mass, last } = this.data.parts[number];
    const [left, top] = this.at([x, z]);
    const [c, s] = [this.zoom * cos, this.zoom * sin];
    const group = svg("g", { class: "body", "data-body": at, transform: `matrix(${c} ${-s} ${-s} ${-c} ${left} ${top})` });
    const kind = last ? "part last" : "part";
    for (const outline of outlines) {
      if (Array.isArray(outline)) {
        group.append(svg("polygon", { class: kind, points: outline.map((corner) => corner.join(",")).join(" ") }));
      } else if (outline.radius > 0) {
        group.append(svg("circle", { class: kind, cx: outline.center[0], cy: outline.center[1], r: outline.radius }));
      } else {
        group.append(svg("circle", { class: "tip", cx: outline.center[0], cy: outline.center[1], r: 4 / this.zoom }));
      }
    }
    if (com) {
      const radius = 2 + 6 * Math.sqrt(mass / this.data.scale.mass);
      group.append(svg("circle", { class: "com", cx: com[0], cy: com[1], r: radius / this.zoom, "vector-effect": "non-scaling-stroke" }));
    }
    return group;
  }

  skeleton({ bones, joints, loops = [] }) {
    const bone = ([x, z, toX, toZ, body]) => {
      const [[x1, y1], [x2, y2]] = [this.at([x, z]), this.at([toX, toZ])];
      return svg("line", { class: "bone", "data-body": body, x1, y1, x2, y2 });
    };
    const joint = (kind) => (point) => {
      const [cx, cy] = this.at(point);
      return svg("circle", { class: kind, cx, cy, r: 3.6 });
    };
    return [...bones.map(bone), ...joints.map(joint("joint")), ...loops.map(joint("joint loop"))];
  }

  /** Returns the contacts and arrows; those of the chosen outcome are on top. */
  contacts({ pose, outcomes }, chosen) {
    const shapes = [];
    const shown = chosen === null ? outcomes : outcomes.slice(chosen, chosen + 1);
    pose.contacts.forEach(({ point, normal, before }, contact) => {
      const [x1, y1] = this.at(point);
      const [x2, y2] = [x1 + 34 * normal[0], y1 - 34 * normal[1]];
      const others = shown.flatMap(({ impulse, after }) => [impulse[contact], after[contact]].map((pair) => world(normal, pair)));
      shapes.push(svg("line", { class: "normal", x1, y1, x2, y2 }), this.arriving(point, before, normal, others));
    });
    for (const { point, vector } of pose.applied ?? []) shapes.push(this.vector("applied", "impulse", point, vector));
    const tips = [];
    const drawn = outcomes.map((outcome, number) => this.outcome(pose, outcome, number, chosen, tips));
    if (chosen !== null && drawn[chosen]) drawn.push(drawn[chosen]);
    shapes.push(...drawn);
    for (const { at: [x, y], link, numbers } of tips) {
      const words = [...(link ? [link] : []), ...(outcomes.length > 1 ? numbers : [])].join(", ");
      if (words) shapes.push(svg("text", { x, y, dx: 5, dy: -4 }, words));
    }
    const named = pose.contacts.map(({ point, name }, contact) => {
      const signs = shown.map(({ after }) => after[contact]).filter((pair) => this.isSmall(pair)).map(([t, n]) => (n !== 0 ? "↑" : t > 0 ? "→" : "←"));
      return { at: this.at(point), name: [this.data.texts[name], ...new Set(signs)].join(" ") };
    });
    shapes.push(...named.map(({ at: [cx, cy] }) => svg("circle", { class: "contact", cx, cy, r: 3.2 })));
    return [...shapes, ...this.names(named)];
  }

  /** Returns whether a velocity after is too small for an arrow. */
  isSmall(pair) {
    return moves(pair) && Math.hypot(...pair) * this.length.velocity < Robot.SEEN;
  }

  /** Returns names below points. The names of points near each other are below each other. */
  names(named) {
    const rows = [];
    return named.sort((a, b) => a.at[0] - b.at[0]).map(({ at: [x, y], name }) => {
      const half = 3.6 * name.length;
      const free = rows.findIndex((end) => end < x - half);
      const row = free < 0 ? rows.length : free;
      rows[row] = x + half;
      return svg("text", { x, y: y + 17 + 14 * row, "text-anchor": "middle" }, name);
    });
  }

  outcome({ contacts, loops }, { impulse, after, loops: inLoops = [] }, number, chosen, tips) {
    const group = svg("g", { class: chosen === null || chosen === number ? "effect" : "effect faded", "data-outcome": number + 1 });
    const draw = (kind, unit, point, vector, link) => {
      const drawn = this.vector(kind, unit, point, vector);
      group.append(drawn);
      if (!drawn.tip) return;
      // Arrows that end near each other have one label.
      const near = tips.find(({ at: [x, y], link: other }) => other === link && Math.hypot(x - drawn.tip[0], y - drawn.tip[1]) < 16);
      if (near) near.numbers.add(number + 1);
      else tips.push({ at: drawn.tip, link, numbers: new Set([number + 1]) });
    };
    contacts.forEach(({ point, normal }, contact) => {
      draw("impulse", "impulse", point, world(normal, impulse[contact]));
      draw("velocity", "velocity", point, world(normal, after[contact]));
    });
    inLoops.forEach(([link, vector], at) => draw("in-loop", "impulse", loops[at], vector, this.data.texts[link]));
    return group;
  }

  /** Returns the arrow of a vector at a point of the world. An arrow that is too long is cut and dashed. */
  vector(kind, unit, point, [x, z]) {
    const from = this.at(point);
    const length = Math.hypot(x, z) * this.length[unit];
    if (!(length > 0) || !Number.isFinite(length)) return svg("g");
    const part = Math.min(1, this.longest / length) * this.length[unit];
    const tip = [from[0] + part * x, from[1] - part * z];
    const drawn = arrow(length > this.longest ? `${kind} cut` : kind, from, tip);
    if (length > 4) drawn.tip = tip;
    return drawn;
  }

  /** Returns a velocity before. It ends at the contact, or next to it if one of `others` or the ground is along it. */
  arriving(point, [x, z], [nx, nz], others) {
    const drawn = this.vector("before", "before", point, [x, z]);
    const length = Math.hypot(x, z);
    const along = others.find(([a, b]) => a * x + b * z < 0 && Math.abs(a * z - b * x) < Robot.ALONG * length * Math.hypot(a, b));
    const side = along ? (along[0] * z - along[1] * x > 0 ? -1 : 1) * Robot.ASIDE / length : 0;
    const [across, up] = Math.abs(x * nx + z * nz) < Robot.ALONG * length ? [Robot.ASIDE * nx, Robot.ASIDE * nz] : [side * z, -side * x];
    const [left, top] = this.at(point);
    const [right, low] = drawn.tip ?? [left, top];
    drawn.setAttribute("transform", `translate(${left - right + across} ${top - low - up})`);
    return drawn;
  }

  /** Fills the legend: an arrow of a round length for each kind of arrow. */
  key() {
    const { frames, scale: { impulse, velocity, before }, wording: { given, taken, moving } } = this.data;
    const some = (chosen) => frames.some((frame) => frame.pose && chosen(frame));
    const after = (chosen) => some((frame) => frame.outcomes.some((outcome) => outcome.after.some(chosen)));
    const small = after((pair) => this.isSmall(pair)) ? " (← → ↑: too small for an arrow)" : "";
    const entries = [
      ["impulse", "impulse", impulse, given[1], `${given[0]} of the ground`, some((frame) => frame.outcomes.some((outcome) => outcome.impulse.some(moves)))],
      ["applied", "impulse", impulse, given[1], `applied ${given[0]}`, some((frame) => frame.pose.applied)],
      ["in-loop", "impulse", impulse, given[1], `${given[0]} in a loop, on the link at its tip`, some((frame) => frame.pose.loops)],
      ["velocity", "velocity", velocity, taken[1], taken[0], after(moves)],
      ["before", "before", before, "m/s", `${moving}, toward the contact`, some((frame) => frame.pose.contacts.some((contact) => moves(contact.before)))],
    ];
    this.legend.replaceChildren();
    for (const [kind, unit, usual, name, words, drawn] of entries) {
      if (!drawn || !(usual > 0)) continue;
      const value = round(0.9 * usual);
      const length = value * this.length[unit];
      const sign = svg("svg", { width: length, height: 12, "aria-hidden": true }, arrow(kind, [0, 6], [length, 6]));
      this.legend.append(html("span", {}, sign, `${words}, ${Number(value.toPrecision(1))} ${name}${kind === "velocity" ? small : ""}`));
    }
    const isCut = (usual) => ([x, z]) => Math.hypot(x, z) * Robot.USUAL > usual * Robot.LONGEST;
    const cut = ({ pose, outcomes }) => [...(pose.applied ?? []).map(({ vector }) => vector),
      ...outcomes.flatMap((outcome) => [...outcome.impulse, ...(outcome.loops ?? []).map(([, vector]) => vector)])].some(isCut(impulse))
      || outcomes.some((outcome) => outcome.after.some(isCut(velocity))) || pose.contacts.some((contact) => isCut(before)(contact.before));
    if (some(cut)) this.legend.append(html("span", {}, "dash-dotted: longer than drawn"));
  }
}

/** Returns a pair along the tangent, which is the normal turned clockwise, and the normal, in the world frame. */
function world([nx, nz], [t, n]) {
  return [t * nz + n * nx, n * nz - t * nx];
}

function moves([t, n]) {
  return t !== 0 || n !== 0;
}
