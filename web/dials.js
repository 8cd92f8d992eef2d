// A slider and a number for each entry of a state.

/** An entry of a state, by its path in the object. */
class Dial {
  /** `changed` is called when it was moved. */
  constructor({ label, unit, path, low, high }, changed) {
    const step = round((high - low) / 400);
    Object.assign(this, { label, unit, path, step, low: Math.floor(low / step) * step, high: Math.ceil(high / step) * step });
    const id = `dial-${path.join("-").replace(/[^\w-]/gu, (sign) => `_${sign.codePointAt(0)}`)}`;
    this.range = html("input", { type: "range", id, min: this.low, max: this.high, step });
    this.number = html("input", { type: "number", step: "any", ariaLabel: `${label}${unit && ` [${unit}]`}, as a number` });
    const name = html("label", { htmlFor: id }, label, html("small", {}, ` ${unit}`));
    this.element = html("div", { className: "dial" }, name, this.range, this.number);
    this.range.addEventListener("input", () => changed(this, Number(Number(this.range.value).toPrecision(12))));
    this.number.addEventListener("input", () => {
      if (this.number.value !== "" && Number.isFinite(Number(this.number.value))) changed(this, Number(this.number.value));
    });
  }

  /** Its value in a state; 0 where there is none, and no number where each link has its own. */
  of(state) {
    const value = this.path.reduce((part, name) => part?.[name], state) ?? 0;
    return typeof value === "object" ? "by link" : value;
  }

  /** A copy of a state that has this value there. */
  in(state, value) {
    const copy = structuredClone(state);
    const last = this.path.at(-1);
    const part = this.path.slice(0, -1).reduce((part, name) => (part[name] ??= {}), copy);
    part[last] = value;
    return copy;
  }

  show(state) {
    const value = this.of(state);
    const shown = typeof value === "number" ? String(Number(value.toPrecision(6))) : "";
    if (typeof value === "number") {
      // A value outside the range of the slider widens the range.
      this.range.min = Math.min(this.low, Math.floor(value / this.step) * this.step);
      this.range.max = Math.max(this.high, Math.ceil(value / this.step) * this.step);
    }
    this.range.value = typeof value === "number" ? value : this.high;
    this.range.setAttribute("aria-valuetext", `${shown || value} ${this.unit}`);
    if (document.activeElement !== this.number) this.number.value = shown;
  }
}

/** The entries of a robot's states that have dials, in groups. */
function entries({ robot, limits }, state) {
  const floating = robot.base === "floating";
  const base = floating ? (state.stance ? ["pitch"] : state.place === "lowest" ? ["x", "pitch"] : ["x", "z", "pitch"]) : [];
  const isTurn = (name) => robot.joints.find((joint) => joint.name === name)?.type !== "slide";
  const entry = (group, names, part, reach) => names.map((name) => {
    const turns = part === "joints" ? isTurn(name) : name === "pitch";
    const unit = (turns ? "rad" : "m") + (group === "velocity" ? "/s" : "");
    const [low, high] = reach(name, turns);
    return { label: name, unit, path: [group, part, name], low, high };
  });
  const joints = robot.joints.map((joint) => joint.name);
  const usual = (name, turns) => (turns ? [-Math.PI, Math.PI] : [-1, 1]);
  const limit = (name, turns) => limits[joints.indexOf(name)] ?? usual(name, turns);
  const speed = (name, turns) => (turns ? [-10, 10] : [-3, 3]);
  const moving = floating ? (state.stance ? ["pitch"] : ["x", "z", "pitch"]) : [];
  return {
    Position: [...entry("position", base, "base", usual), ...entry("position", joints, "joints", limit)],
    Velocity: [...entry("velocity", moving, "base", speed), ...entry("velocity", joints, "joints", speed)],
    Ground: [
      { label: "friction", unit: "", path: ["friction"], low: 0, high: 2 },
      { label: "restitution", unit: "", path: ["restitution"], low: 0, high: 1 },
      ...(state.ground?.profile ? [] : [{ label: "slope", unit: "rad", path: ["ground", "slope"], low: -0.6, high: 0.6 }]),
    ],
  };
}
