// The list of stored shapes, filtered, a page at a time.

import { ask } from "./client.js";
import { by, make, number, say, table } from "./dom.js";

const columns = [["name"], ["class"], ["side"], ["subject"], ["volume, mm³", "number"], ["stored"]];

let next = null;
let latest = 0; // answers of older filters are dropped

function row(shape) {
	return [make("a", { href: `#shape=${shape.id}` }, shape.name ?? shape.id.slice(0, 8)), shape.class, shape.side, shape.subject,
		number(shape.volume_mm3, 0), shape.created.slice(0, 10)];
}

function filter() {
	return Object.fromEntries(new FormData(by("filter")));
}

export async function listShapes() {
	const asked = ++latest;
	const page = await ask("/shapes", { ...filter(), limit: 50 });
	if (asked !== latest)
		return;
	next = page.next;
	by("more").hidden = !next;
	by("library").replaceChildren(page.shapes.length ? table("Shapes", columns, page.shapes.map(row))
		: make("p", {}, "No shape fits. Enroll some with eskel enroll FILE, or curl -T FILE …/shapes."));
}

export async function listMore() {
	const asked = latest;
	const page = await ask("/shapes", { ...filter(), limit: 50, cursor: next });
	if (asked !== latest)
		return;
	next = page.next;
	by("more").hidden = !next;
	const added = table("", columns, page.shapes.map(row)).querySelectorAll("tbody tr");
	by("library").querySelector("tbody").append(...added);
	say(`${page.shapes.length} more shapes`);
}
