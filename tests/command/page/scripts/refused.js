press("Home");
const refused = { scene: one("#scene").textContent, sentence: text(".sentence"), bodies: all(".body").length };
press("End");
found({ refused, answered: { sentence: text(".sentence"), bodies: all(".body").length } });
