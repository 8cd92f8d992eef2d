press("End", "PageDown");
const inside = (element) => { const { left, right } = element.getBoundingClientRect(); return left >= 0 && right <= innerWidth; };
found({ width: document.documentElement.scrollWidth, window: innerWidth, inside: ["#axis0", "#scene", "#answer", "#plots", ".track"].map((part) => inside(one(part))) });
