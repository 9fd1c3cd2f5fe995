// Requests to the server that this page came from. The token lives in this variable and nowhere else.

let token = "";

export function setToken(text) {
	token = text.trim();
}

// The server's own sentence where it sent one.
async function refusal(response) {
	let detail = `the server answered ${response.status}`;
	try {
		detail = (await response.json()).detail ?? detail;
	} catch { /* not a problem document */ }
	const error = new Error(detail);
	error.status = response.status;
	return error;
}

// parameters: empty values are left out. Returns the JSON of the answer, throws an Error with one sentence.
export async function ask(path, parameters = {}, options = {}) {
	const query = new URLSearchParams(Object.entries(parameters).filter(([, value]) => value !== "" && value !== null));
	const headers = { ...(options.body ? { "Content-Type": "application/octet-stream" } : {}),
		...(token ? { Authorization: `Bearer ${token}` } : {}) };
	const response = await fetch(query.size ? `${path}?${query}` : path, { ...options, headers, cache: "no-store" });
	if (!response.ok)
		throw await refusal(response);
	return response.json();
}
