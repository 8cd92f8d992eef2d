// The page as a whole: the current stop, and the inputs that change it.

{
  const data = JSON.parse(document.getElementById("data").textContent);
  const { axes, frames, regions, texts } = data;
  const here = axes.map(() => 0);
  let chosen = null;

  /** Returns the frame at these stops; the stop of the last axis changes fastest. */
  const still = (stops) => frames[stops.reduce((index, stop, axis) => index * axes[axis].values.length + stop, 0)];

  const robot = new Robot(document.getElementById("scene"), document.getElementById("key"), data);
  const answer = new Answer(document.getElementById("answer"), data, (outcome) => choose(outcome));
  const plots = new Plots(document.getElementById("plots"), data, (values) => go(axes.map(({ values: all }, axis) => nearest(all, values[axis]))));
  const sliders = axes.map((_, axis) => new Slider(document.getElementById("control"), data, axis, (stop) => go(here.with(axis, stop))));

  function go(stops) {
    stops.forEach((stop, axis) => { here[axis] = Math.min(axes[axis].values.length - 1, Math.max(0, stop)); });
    const outcomes = still(here).outcomes.length;
    if (chosen !== null && chosen >= outcomes) chosen = null;
    show();
  }

  function choose(outcome) {
    chosen = outcome !== null && outcome < still(here).outcomes.length ? outcome : null;
    show();
  }

  function show() {
    const frame = still(here);
    const region = regions[frame.region];
    const words = `${region ? `region ${region.name}, ` : ""}${texts[frame.sentence]}`;
    sliders.forEach((slider, axis) => slider.show(here[axis], frame.name ?? "", words));
    robot.show(frame, chosen);
    answer.show(frame, chosen);
    plots.show(axes.map(({ values }, axis) => values[here[axis]]));
    document.getElementById("scene").setAttribute("aria-label", `The robot: ${words}`);
    const outcomes = frame.outcomes.map((outcome, number) => `${number + 1}: ${texts[outcome.words]}`);
    document.getElementById("status").textContent = [words, ...outcomes].join(" ");
  }

  /** Returns the stops after moving along the first axis beyond the next border, or to the end. */
  const beyond = (way) => here.with(0, border(axes[0].values.map((_, stop) => still(here.with(0, stop)).region), here[0], way));

  /** Returns the middle of the most interesting run of stops: several outcomes or none before one, then the longest. */
  function telling() {
    const says = ({ verdict, outcomes }) => (verdict === "none" || outcomes.length > 1 ? 3 : verdict === "unique" ? 2 : verdict ? 1 : 0);
    let best = { says: -1, length: 0, at: 0 };
    for (let from = 0, to; from < frames.length; from = to) {
      for (to = from + 1; to < frames.length && frames[to].region === frames[from].region; ) to += 1;
      const run = { says: says(frames[from]), length: to - from, at: Math.floor((from + to - 1) / 2) };
      if (run.says > best.says || (run.says === best.says && run.length > best.length)) best = run;
    }
    return axes.map((_, axis) => Math.floor(best.at / axes.slice(axis + 1).reduce((count, { values }) => count * values.length, 1)) % axes[axis].values.length);
  }

  const along = (axis, way) => here.with(axis, here[axis] + way);
  /** Moves along the axis whose slider has the focus, or else along this axis. */
  const step = (axis, way) => {
    const held = sliders.findIndex(({ input }) => input === document.activeElement);
    go(along(held < 0 ? axis : held, way));
  };
  const upright = axes.length - 1;
  const keys = {
    ArrowLeft: () => step(0, -1),
    ArrowRight: () => step(0, 1),
    ArrowDown: () => step(upright, -1),
    ArrowUp: () => step(upright, 1),
    PageUp: () => go(beyond(1)),
    PageDown: () => go(beyond(-1)),
    Home: () => go(here.with(0, 0)),
    End: () => go(here.with(0, axes[0].values.length - 1)),
    Escape: () => choose(null),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const action = keys[event.key] ?? (/^[0-9]$/.test(event.key) ? () => choose(event.key === "0" ? null : Number(event.key) - 1) : null);
    if (!action) return;
    event.preventDefault();
    action();
  });

  document.getElementById("control").append(buttons({
    step: (way) => go(along(0, way)),
    border: (way) => go(beyond(way)),
    again: () => here[0] === axes[0].values.length - 1 && (go(here.with(0, 0)), true),
  }));

  const signs = "t is along the ground, n away from it; slide forward is along t";
  for (const note of [signs, ...data.notes]) document.getElementById("notes").append(html("p", {}, `Note: ${note}.`));
  go(telling());
}
