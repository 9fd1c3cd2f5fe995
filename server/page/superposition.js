// A neighbour laid over what was recognized, by the isometry of the answer: both as ellipses, one colour each.

import { drawn, make, number } from "./dom.js";
import { drawLevel } from "./drawing.js";

// What maps x to matrix x maps nodes as well.
function moved(node, matrix) {
	const linear = matrix.map((row) => row.slice(0, 3));
	const times = (a, b) => a.map((row) => b[0].map((_, c) => row.reduce((sum, value, i) => sum + value * b[i][c], 0)));
	const transposed = linear[0].map((_, c) => linear.map((row) => row[c]));
	return {
		...node,
		centre_mm: matrix.map((row) => row[0] * node.centre_mm[0] + row[1] * node.centre_mm[1] + row[2] * node.centre_mm[2] + row[3]),
		covariance_mm2: times(times(linear, node.covariance_mm2), transposed),
	};
}

// The inverse of an isometry.
function inverse(matrix) {
	return [0, 1, 2].map((r) => [...[0, 1, 2].map((c) => matrix[c][r]),
		-matrix.reduce((sum, row) => sum + row[r] * row[3], 0)]);
}

const hues = { shape: 210, other: 30 };

// matrix lays nodes on others; both are drawn where nodes are.
function drawOver(nodes, others, matrix, names) {
	const back = inverse(matrix);
	return drawLevel([...others.map((node) => ({ ...moved(node, back), hue: hues.other, of: names.other })),
		...nodes.map((node) => ({ ...node, hue: hues.shape, of: names.shape }))]);
}

function key(hue, text) {
	return make("span", {}, drawn("svg", { class: "key", viewBox: "0 0 1 1", "aria-hidden": true },
		drawn("circle", { cx: .5, cy: .5, r: .5, fill: `hsl(${hue} 60% 50%)` })), text);
}

// A neighbour laid over the shape, drawn when it is looked at; another one can be chosen.
export function superposition(title, { classes, neighbours }) {
	const some = neighbours.filter((n) => n.superposition);
	if (!some.length)
		return null;
	const names = some.map((n) => [n.name ?? n.id.slice(0, 8), n.subject].filter(Boolean).join(", "));
	const view = make("div");
	const show = (i) => {
		const { superposition: laid, isomorphism, classes: others } = some[i];
		view.replaceChildren(drawOver(classes, others, laid.matrix, { shape: title, other: names[i] }),
			make("p", { class: "note keys" }, key(hues.shape, title),
				key(hues.other, `${names[i]}, ${laid.mirrored ? "mirrored and " : ""}laid over it`)),
			make("p", { class: "note" }, `Class centres lie ${number(laid.rms_mm)} mm apart (root mean square); ` +
				`the trees agree down to level ${isomorphism.depth}.`));
	};
	const choice = make("select", { onchange: (event) => show(event.target.selectedIndex) },
		names.map((name) => make("option", {}, name)));
	const draw = (event) => {
		if (event.target.open && !view.firstChild)
			show(choice.selectedIndex);
	};
	return make("details", { class: "over", ontoggle: draw }, make("summary", {}, "Show a neighbour laid over it"),
		make("label", { class: "level" }, "Neighbour ", choice), view);
}
