// The answer of /recognize: for each label the verdict, what it rests on, and the nearest shapes.

import { facts, make, number, table } from "./dom.js";
import { superposition } from "./superposition.js";

function percent(score) {
	return typeof score === "number" ? `${Math.min(Math.round(score * 100), 99)} %` : "–";
}

// A verdict's class or side, and how probable it is.
function score(name, value, of, otherwise) {
	return make("p", { class: "score" },
		make("span", {}, name), make("strong", {}, value ?? otherwise),
		value ? make("meter", { min: 0, max: 1, value: of ?? 0 }) : null,
		value ? make("span", { class: "note" }, percent(of)) : null);
}

function agreement({ query, verdict }) {
	const recorded = [query.class, query.side].filter(Boolean).join(", ");
	if (verdict.agrees === true)
		return make("p", { class: "good" }, `✓ agrees with what is recorded: ${recorded}`);
	if (verdict.agrees === false)
		return make("p", { class: "bad" }, `✗ contradicts what is recorded: ${recorded}`);
	return null;
}

function tooFar(verdict) {
	if (verdict.class || !verdict.nearest_class)
		return null;
	return make("p", { class: "note" }, `The nearest is of class ${verdict.nearest_class}, but ` +
		`${number(verdict.distance_z, 1)} standard deviations farther away than its fellows are from each other.`);
}

function searched(search) {
	const sure = search.proven ? "proven to be the nearest" : "not proven to be the nearest";
	return `${search.mode} search among ${search.library} shapes in ${number(search.milliseconds)} ms, ` +
		`${search.compared} compared in full, ${sure}`;
}

function handedness({ verdict, score: of }) {
	return verdict === "undecided" ? "undecided" : `${verdict} (${number(of, 2)})`;
}

function neighbours(list) {
	const rows = list.map((n, i) => [String(i + 1), make("a", { href: `#shape=${n.id}` }, n.name ?? n.id.slice(0, 8)), n.class,
		n.side, n.subject, number(n.distance, 4), handedness(n.chirality)]);
	return table("Nearest shapes", [["", "number"], ["name"], ["class"], ["side"], ["subject"], ["distance", "number"],
		["handedness"]], rows);
}

// Sentences about the classes that differ from those of the nearest shape; those that stand out are bold.
function differences(nearest) {
	const sentences = (nearest?.differences ?? []).filter((d) => d.text);
	if (!nearest?.summary)
		return null;
	return make("details", {}, make("summary", {}, `What differs from ${nearest.name ?? "the nearest"}: ${nearest.summary.text}`),
		make("ul", {}, sentences.map((d) => make("li", {}, d.remarkable ? make("strong", {}, d.text) : d.text))));
}

function title({ query }) {
	return query.name ?? (query.url ? query.id.slice(0, 8) : `label ${query.label}`);
}

function card(result) {
	const { query, verdict, search } = result;
	return make("article", { class: "card" },
		make("h3", {}, title(result)),
		score("class", verdict.class, verdict.class_score, "unknown"),
		tooFar(verdict),
		score("side", verdict.side, verdict.side_score, "undecided"),
		agreement(result),
		result.neighbours.length ? neighbours(result.neighbours) : make("p", {}, "There is nothing to compare it with."),
		differences(result.neighbours[0]),
		superposition(title(result), result),
		facts([["label", String(query.label)], ["voxels", number(query.voxels, 0)], ["volume", `${number(query.volume_mm3, 0)} mm³`]]),
		query.warnings.map((warning) => make("p", { class: "note" }, warning.text)),
		make("p", { class: "note" }, searched(search)));
}

function summary(results) {
	const says = { true: "yes", false: "no", null: "–" };
	return table("Verdicts", [["label"], ["class"], ["score", "number"], ["side"], ["score", "number"], ["agrees"]],
		results.map((result) => [title(result), result.verdict.class ?? "unknown", percent(result.verdict.class && result.verdict.class_score), result.verdict.side,
			percent(result.verdict.side_score), says[result.verdict.agrees]]));
}

export function showRecognition({ results }, into) {
	into.replaceChildren(...(results.length > 1 ? [summary(results)] : []), ...results.map(card));
	if (results.length === 1)
		into.querySelector("details.over")?.setAttribute("open", "");
}
