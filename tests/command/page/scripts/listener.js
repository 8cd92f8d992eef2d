const wrong = [];
addEventListener("error", (event) => wrong.push(String(event.message)));
addEventListener("securitypolicyviolation", (event) => wrong.push(`${event.violatedDirective} ${event.blockedURI}`));
for (const kind of ["error", "warn"]) console[kind] = (...what) => wrong.push(what.join(" "));
globalThis.alert = (what) => wrong.push(`alert ${what}`);
// The browser's virtual time does not wait for what is compiled beside it.
WebAssembly.instantiate = async (bytes) => ({ instance: new WebAssembly.Instance(new WebAssembly.Module(bytes)) });
