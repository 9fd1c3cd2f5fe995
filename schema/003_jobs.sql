-- Step 3: long answers that nobody waits for. A row is one from the moment that a job is accepted to its removal.

CREATE TABLE job (
	number INTEGER PRIMARY KEY AUTOINCREMENT,            -- the order in which they run
	id TEXT NOT NULL UNIQUE CHECK (length(id) = 32),
	created INTEGER NOT NULL DEFAULT (unixepoch()),
	request TEXT NOT NULL,                               -- all that is needed to answer it again, as the API writes it
	state TEXT NOT NULL DEFAULT 'queued' CHECK (state IN ('queued', 'done', 'failed')),
	starts INTEGER NOT NULL DEFAULT 0,                   -- how often it began to run and the server was gone before its end
	-- Of the answer.
	status INTEGER NOT NULL DEFAULT 0,
	content_type TEXT,
	size INTEGER NOT NULL DEFAULT 0,
	seconds REAL NOT NULL DEFAULT 0,
	problem TEXT
) STRICT;
