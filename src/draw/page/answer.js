// The answer: verdict, outcomes, notes, and the transitions at the next borders.

/** Formats a number with `count` significant digits. */
function digits(value, count = 4) {
  if (value === null || value === undefined) return "–";
  const isShort = Math.abs(value) >= 1e-4 && Math.abs(value) < 10 ** Math.max(6, count);
  const text = isShort ? Number(value.toPrecision(count)).toString() : value.toExponential(count - 2);
  return value === 0 ? "0" : text.replaceAll("-", "−");
}

class Answer {
  /** `choose` takes the index of an outcome, or null for all. */
  constructor(element, data, choose) {
    this.element = element;
    this.data = data;
    this.choose = choose;
  }

  show(frame, chosen) {
    const { texts, regions } = this.data;
    const region = regions[frame.region];
    const kept = this.element.contains(document.activeElement) ? document.activeElement.dataset.outcome : null;
    const sentence = html("p", { className: "sentence" });
    if (region) {
      const badge = html("span", { className: "badge" }, region.name);
      badge.style.background = region.fill;
      sentence.append(badge);
    }
    sentence.append(texts[frame.sentence]);
    if (frame.proven !== undefined) sentence.append(frame.proven ? " Proven." : " Not proven.");
    this.element.replaceChildren(sentence);
    if (frame.pose?.contacts.length) this.element.append(html("div", { className: "wide" }, this.table(frame, chosen)));
    for (const note of frame.notes ?? []) this.element.append(html("p", {}, `Note: ${texts[note]}`));
    if (region?.borders.length) {
      const entry = ([where, what]) => [html("dt", {}, where), html("dd", {}, what)];
      this.element.append(html("dl", {}, ...region.borders.flatMap(entry)));
    }
    if (kept) this.element.querySelector(`button[data-outcome="${kept}"]`)?.focus();
  }

  table({ pose: { contacts }, outcomes }, chosen) {
    const { given, taken } = this.data.wording;
    const head = (text, span) => html("th", { scope: "col", colSpan: span }, text);
    const table = html("table", {}, html("thead", {}, html("tr", {},
      head("contact", 1), ...[given, taken].map(([name, unit]) => head(`${name} t, n [${unit}]`, 2)))));
    outcomes.forEach((outcome, number) => {
      const body = html("tbody", { className: chosen === null || chosen === number ? "" : "faded" }, html("tr", {}, this.outcome(outcome, number, chosen)));
      contacts.forEach(({ name }, contact) => {
        const cells = [...outcome.impulse[contact], ...outcome.after[contact]].map((entry) => html("td", {}, digits(entry)));
        body.append(html("tr", {}, html("td", {}, this.data.texts[name]), ...cells));
      });
      table.append(body);
    });
    return table;
  }

  outcome({ words, marks = [], margin, index, energy_loss }, number, chosen) {
    const { texts } = this.data;
    const button = html("button", { type: "button", onclick: () => this.choose(chosen === number ? null : number) }, String(number + 1));
    button.dataset.outcome = number + 1;
    button.setAttribute("aria-pressed", chosen === number);
    button.setAttribute("aria-label", `Show outcome ${number + 1} alone`);
    const sign = index === null ? "–" : index > 0 ? "+1" : "−1";
    const grades = [`margin ${digits(margin)}`, `index ${sign}`, `${digits(energy_loss)} ${this.data.wording.lost}`, ...marks.map((mark) => texts[mark])];
    return html("th", { scope: "rowgroup", className: "outcome", colSpan: 5 }, button, ` ${texts[words]}`, html("br"), html("small", {}, grades.join(", ")));
  }
}
