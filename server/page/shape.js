// One stored shape: what is recorded, its skeleton level by level, and what it is recognized as.

import { ask } from "./client.js";
import { by, facts, make, number, say, table } from "./dom.js";
import { drawLevel } from "./drawing.js";
import { showRecognition } from "./recognition.js";

function recorded(shape) {
	return facts([["class", shape.class], ["side", shape.side], ["subject", shape.subject], ["age", shape.age && String(shape.age)],
		["sex", shape.sex], ...Object.entries(shape.attributes), ["voxels", number(shape.voxels, 0)],
		["volume", `${number(shape.volume_mm3, 0)} mm³`], ["centre (RAS)", `${shape.centre_mm.map((x) => number(x)).join(", ")} mm`],
		["stored", shape.created], ["id", make("code", {}, shape.id)]]);
}

function classes(nodes) {
	return table("Classes", [["class", "number"], ["voxels", "number"], ["half axes, mm", "number"], ["ρ, mm", "number"]],
		nodes.map((node) => [String(node.class), number(node.voxels, 0),
			node.eigenvalues_mm2.map((value) => number(Math.sqrt(5 * value))).join(" × "), number(node.rho_mm)]));
}

function levels(skeleton) {
	const most = skeleton.levels.length, view = make("div");
	const output = make("output", {});
	const show = (level) => {
		const { nodes, intraclass_ratio: ratio } = skeleton.levels[level - 1];
		const chosen = nodes.map((id) => skeleton.nodes[id]);
		output.textContent = `${level} of ${most}: ${number(100 * ratio)} % of the variance is within the classes`;
		view.replaceChildren(drawLevel(chosen), classes(chosen));
	};
	const slider = make("input", { type: "range", min: 1, max: most, value: Math.min(10, most),
		oninput: (event) => show(Number(event.target.value)) });
	show(Math.min(10, most));
	return [make("label", { class: "level" }, "Level ", slider, output), view];
}

async function recognize(shape, into) {
	say("Recognizing …");
	showRecognition(await ask("/recognize", { shape: shape.id, explain: "true" }), into);
	say("");
}

export async function showShape(id, guard) {
	const shape = await ask(`/shapes/${id}`);
	const skeleton = await ask(`/shapes/${id}/skeleton`);
	const answer = make("div");
	by("shape-title").textContent = shape.name ?? id.slice(0, 8);
	by("shape").replaceChildren(recorded(shape),
		...shape.warnings.map((warning) => make("p", { class: "note" }, warning.text)),
		make("p", {}, make("button", { class: "main", onclick: guard(() => recognize(shape, answer)) }, "Recognize it among the others"),
			" ", make("a", { href: "#" }, "Close")),
		answer, ...levels(skeleton));
	by("shape-section").hidden = false;
	by("shape-title").focus();
}

export function hideShape() {
	by("shape-section").hidden = true;
	by("shape").replaceChildren();
}
