-- Step 2: who may do something, and who did.

CREATE TABLE token (
	number INTEGER PRIMARY KEY AUTOINCREMENT,
	sha256 BLOB NOT NULL UNIQUE CHECK (length(sha256) = 32),  -- of the text, which is not kept
	name TEXT NOT NULL,
	role TEXT NOT NULL CHECK (role IN ('read', 'write', 'admin')),
	created INTEGER NOT NULL,                                 -- Unix seconds, as the next two; NULL: never
	expires INTEGER,
	revoked INTEGER
) STRICT;

-- One row a change, each with a hash over itself and the row before (audit.c). shape is an id, not a reference:
-- the row outlives its shape.
CREATE TABLE audit (
	number INTEGER PRIMARY KEY AUTOINCREMENT,
	time INTEGER NOT NULL,
	actor TEXT,
	action TEXT NOT NULL CHECK (action IN ('enroll', 'describe', 'delete', 'token add', 'token revoke')),
	shape TEXT,
	revision INTEGER,
	token INTEGER,
	hash BLOB NOT NULL CHECK (length(hash) = 32)
) STRICT;
