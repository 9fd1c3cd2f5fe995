// Elements from names, properties and text. Whatever the server says becomes text, never markup.

function fill(element, children) {
	for (const child of children.flat()) {
		if (child !== null && child !== undefined)
			element.append(child);
	}
	return element;
}

// Properties that begin with "on" are listeners, the others attributes; null leaves one out.
export function make(name, properties = {}, ...children) {
	const element = document.createElement(name);
	for (const [key, value] of Object.entries(properties)) {
		if (key.startsWith("on"))
			element.addEventListener(key.slice(2), value);
		else if (value !== null)
			element.setAttribute(key, value);
	}
	return fill(element, children);
}

export function drawn(name, attributes = {}, ...children) {
	const element = document.createElementNS("http://www.w3.org/2000/svg", name);
	for (const [key, value] of Object.entries(attributes))
		element.setAttribute(key, value);
	return fill(element, children);
}

// columns: [title, "number" or nothing]; rows: arrays of text or elements.
export function table(caption, columns, rows) {
	const kind = (i) => ({ class: columns[i][1] ?? null });
	return make("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption },
		make("table", {},
			make("caption", {}, caption),
			make("thead", {}, make("tr", {}, columns.map(([title], i) => make("th", { scope: "col", ...kind(i) }, title)))),
			make("tbody", {}, rows.map((row) => make("tr", {}, row.map((cell, i) => make("td", kind(i), cell ?? "–")))))));
}

export function facts(pairs) {
	return make("dl", {}, pairs.filter(([, value]) => value !== null && value !== undefined && value !== "")
		.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))));
}

export function number(value, digits = 1) {
	return typeof value === "number"
		? value.toLocaleString("en", { minimumFractionDigits: digits, maximumFractionDigits: digits }) : "–";
}

export function by(id) {
	return document.getElementById(id);
}

export function say(text, isError = false) {
	by("status").textContent = text;
	by("status").classList.toggle("error", isError);
}
