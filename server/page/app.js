// The page: what each control does. Its parts are in the modules beside it.

import { ask, setToken } from "./client.js";
import { by, say } from "./dom.js";
import { listMore, listShapes } from "./library.js";
import { showRecognition } from "./recognition.js";
import { hideShape, showShape } from "./shape.js";

// A listener whose failure becomes a sentence on the page.
function guard(work) {
	return async (event) => {
		try {
			await work(event);
		} catch (error) {
			if (error.name === "AbortError") {
				say("Cancelled.");
				return;
			}
			say(error.message, true);
			if (error.status === 401)
				by("token").focus();
		}
	};
}

async function recognizeFile() {
	const [file] = by("file").files;
	if (!file)
		return;
	const options = Object.fromEntries(new FormData(by("recognize")));
	delete options.file;
	const cancelling = new AbortController();
	by("cancel").hidden = false;
	by("cancel").onclick = () => cancelling.abort();
	by("answer").replaceChildren();
	say(`Sending ${(file.size / 1e6).toFixed(1)} MB …`);
	try {
		const answer = await ask("/recognize", { ...options, explain: "true" },
			{ method: "POST", body: file, signal: cancelling.signal });
		showRecognition(answer, by("answer"));
		say(answer.results.length === 1 ? "One label was recognized." : `${answer.results.length} labels were recognized.`);
		by("answer").focus();
	} finally {
		by("cancel").hidden = true;
	}
}

async function followAddress() {
	const id = /^#shape=([0-9a-f]{32})$/.exec(location.hash)?.[1];
	if (id)
		await showShape(id, guard);
	else
		hideShape();
}

function takeDrops(area) {
	const mark = (over) => (event) => {
		event.preventDefault();
		area.classList.toggle("over", over);
	};
	area.addEventListener("dragover", mark(true));
	area.addEventListener("dragleave", mark(false));
	area.addEventListener("drop", (event) => {
		mark(false)(event);
		if (!event.dataTransfer.files.length)
			return;
		by("file").files = event.dataTransfer.files;
		by("recognize").requestSubmit();
	});
}

function start() {
	const refresh = guard(async () => {
		await listShapes();
		say("");
	});
	by("access").addEventListener("submit", (event) => {
		event.preventDefault();
		setToken(by("token").value);
		refresh().then(guard(followAddress));
	});
	by("recognize").addEventListener("submit", (event) => {
		event.preventDefault();
		guard(recognizeFile)();
	});
	let soon = 0;
	by("filter").addEventListener("submit", (event) => event.preventDefault());
	by("filter").addEventListener("input", () => {
		clearTimeout(soon);
		soon = setTimeout(refresh, 200);
	});
	by("more").addEventListener("click", guard(listMore));
	addEventListener("hashchange", guard(followAddress));
	takeDrops(by("drop"));
	refresh().then(guard(followAddress));
}

start();
