-- Step 1: shapes, what people say of them, and what was computed from them.

CREATE TABLE shape (
	-- AUTOINCREMENT: a key is never used again, so a cursor or a library in memory cannot take a new shape for an old one.
	key INTEGER PRIMARY KEY AUTOINCREMENT,
	-- Of the encoded canonical cloud: the same object is the same shape, whatever file it came from.
	sha256 BLOB NOT NULL CHECK (length(sha256) = 32),
	id TEXT NOT NULL UNIQUE AS (lower(hex(substr(sha256, 1, 16)))),
	revision INTEGER NOT NULL DEFAULT 1,
	created INTEGER NOT NULL DEFAULT (unixepoch()),
	label INTEGER NOT NULL,
	voxels INTEGER NOT NULL CHECK (voxels > 0),
	volume REAL NOT NULL CHECK (volume > 0),  -- mm^3
	centre_x REAL NOT NULL,                   -- mm, RAS
	centre_y REAL NOT NULL,
	centre_z REAL NOT NULL,
	levels INTEGER NOT NULL CHECK (levels > 0),
	name TEXT,
	class TEXT,
	subject TEXT,
	side TEXT CHECK (side IN ('left', 'right', 'none')),
	sex TEXT CHECK (sex IN ('female', 'male')),
	age REAL CHECK (age >= 0)                 -- years
) STRICT;

CREATE INDEX shape_by_class ON shape (class);
CREATE INDEX shape_by_side ON shape (side, class);
CREATE INDEX shape_by_subject ON shape (subject);

CREATE TABLE attribute (
	shape INTEGER NOT NULL REFERENCES shape (key) ON DELETE CASCADE,
	key TEXT NOT NULL,
	value TEXT NOT NULL,
	PRIMARY KEY (shape, key)
) STRICT, WITHOUT ROWID;

CREATE INDEX attribute_by_value ON attribute (key, value);

CREATE TABLE warning (
	shape INTEGER NOT NULL REFERENCES shape (key) ON DELETE CASCADE,
	position INTEGER NOT NULL,
	code TEXT NOT NULL,
	text TEXT NOT NULL,
	PRIMARY KEY (shape, position)
) STRICT, WITHOUT ROWID;

-- The encoded objects, one table each: a scan of the signatures must not read past clouds. sha256 is of bytes and
-- stands before them, where it is read without their overflow pages.

CREATE TABLE cloud (
	shape INTEGER PRIMARY KEY REFERENCES shape (key) ON DELETE CASCADE,
	sha256 BLOB NOT NULL CHECK (length(sha256) = 32),
	bytes BLOB NOT NULL
) STRICT;

CREATE TABLE skeleton (
	shape INTEGER PRIMARY KEY REFERENCES shape (key) ON DELETE CASCADE,
	sha256 BLOB NOT NULL CHECK (length(sha256) = 32),
	bytes BLOB NOT NULL
) STRICT;

CREATE TABLE signature (
	shape INTEGER PRIMARY KEY REFERENCES shape (key) ON DELETE CASCADE,
	sha256 BLOB NOT NULL CHECK (length(sha256) = 32),
	bytes BLOB NOT NULL
) STRICT;
