const seen = () => ({ time: shown("output"), name: text(".name"), badge: text(".badge"), words: text("th.outcome"), x: middle(one(".contact")) });
press("Home");
const list = [seen()];
for (let k = 0; k < 3; k += 1) { press("PageUp"); list.push(seen()); }
press("End");
found({ list, end: seen(), track: all(".track span").length });
