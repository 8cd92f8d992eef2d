const seen = () => ({
    stop: Number(one("#axis0").value), alpha: Number(text("output")), told: one("#axis0").getAttribute("aria-valuetext"),
    hip: one(".joint").getAttribute("cy"), badge: text(".badge"), cursors: all("line.cursor").map(middle),
});
const steps = {};
const then = (name, act) => { act(); steps[name] = seen(); };
then("start", () => {});
then("right", () => press("ArrowRight"));
then("left", () => press("ArrowLeft"));
then("before", () => press("ArrowLeft"));
then("border", () => press("PageUp"));
then("back", () => press("PageDown"));
then("end", () => press("End"));
then("behind", () => press("ArrowUp"));
then("slide", () => slide(0, 2));
then("home", () => press("Home"));
// The shaded parts of a panel, from left to right.
const boxes = all("#plots g[clip-path]").map((group) => group.querySelector("path").getBoundingClientRect());
found({ steps, regions: boxes.map(({ left, right }) => [left, right]), windows: all("line.cursor").length });
