// How far the head of the velocity before is from the contact, and the loop's impulse.
const center = (element) => [Number(element.getAttribute("cx")), Number(element.getAttribute("cy"))];
const [x, y] = center(one(".contact"));
const before = one(".arrow.before");
const moved = before.transform.baseVal.consolidate().matrix;
const [tip] = before.querySelector("polygon").points;
const [right, down] = [tip.x + moved.e - x, tip.y + moved.f - y];
const shaft = one(".arrow.in-loop line");
found({
    names: all("#scene text").map((name) => name.textContent), aside: Math.hypot(right, down), down,
    up: Number(shaft.getAttribute("y2")) < Number(shaft.getAttribute("y1")),
});
