// A level of a skeleton as ellipses, seen along each axis.
//
// A solid ellipsoid with covariance S is { x : x' S^-1 x <= 5 }. Its shadow along an axis is the same of the 2 x 2 block
// that the axis leaves. World space is RAS; as on a radiologist's screen the patient's right is on the left.

import { drawn, make } from "./dom.js";

const views = [
	{ title: "from the front", across: 0, up: 2, edges: ["R", "L"] },
	{ title: "from the left", across: 1, up: 2, edges: ["A", "P"] },
	{ title: "from below", across: 0, up: 1, edges: ["R", "L"] },
];

const margin = 4; // percent of the width

function ellipse(node, view) {
	const a = node.covariance_mm2[view.across][view.across], d = node.covariance_mm2[view.up][view.up];
	const b = -node.covariance_mm2[view.across][view.up]; // across is mirrored
	const mean = (a + d) / 2, spread = Math.hypot((a - d) / 2, b);
	return {
		x: -node.centre_mm[view.across],
		y: -node.centre_mm[view.up],
		long: Math.sqrt(5 * Math.max(mean + spread, 0)),
		short: Math.sqrt(5 * Math.max(mean - spread, 0)),
		turn: -Math.atan2(2 * b, a - d) / 2 * 180 / Math.PI, // SVG's y points down
		hue: node.hue ?? node.class * 137.5 % 360, // neighbouring numbers get distant hues
		opacity: node.hue === undefined ? .35 : .2,
		label: `${node.of ?? ""} class ${node.class}: ${node.voxels} voxels`.trim(),
	};
}

function draw(ellipses, view, extent) {
	const size = extent * (1 + margin / 50);
	const x = (Math.min(...ellipses.map((e) => e.x - e.long)) + Math.max(...ellipses.map((e) => e.x + e.long)) - size) / 2;
	const y = (Math.min(...ellipses.map((e) => e.y - e.long)) + Math.max(...ellipses.map((e) => e.y + e.long)) - size) / 2;
	const text = (at, what) => drawn("text", { x: at, y: y + size * .07, "font-size": size / 16, "text-anchor": "middle" }, what);
	return drawn("svg", { viewBox: `${x} ${y} ${size} ${size}`, role: "img", "aria-label": `the skeleton, ${view.title}` },
		ellipses.map((e) => drawn("ellipse", {
			rx: e.long, ry: e.short, transform: `translate(${e.x} ${e.y}) rotate(${e.turn})`,
			fill: `hsl(${e.hue} 60% 50% / ${e.opacity})`, stroke: `hsl(${e.hue} 60% 45%)`, "stroke-width": size / 150,
		}, drawn("title", {}, e.label))),
		text(x + size * .04, view.edges[0]), text(x + size * .96, view.edges[1]));
}

// All three views at one scale. A node may say its hue, and of what shape it is, where there are two.
export function drawLevel(nodes) {
	const drawings = views.map((view) => nodes.map((node) => ellipse(node, view)));
	const width = (ellipses, at) =>
		Math.max(...ellipses.map((e) => e[at] + e.long)) - Math.min(...ellipses.map((e) => e[at] - e.long));
	const extent = Math.max(...drawings.flatMap((ellipses) => [width(ellipses, "x"), width(ellipses, "y")]), 1e-3);
	return make("div", { class: "drawings" }, drawings.map((ellipses, i) =>
		make("figure", {}, draw(ellipses, views[i], extent), make("figcaption", {}, views[i].title))));
}
