-- Step 4: surfaces that were fitted to shapes (section 2.5: eps, u, alpha of each class), which need no cloud any more.

CREATE TABLE surface (
	shape INTEGER NOT NULL REFERENCES shape (key) ON DELETE CASCADE,
	level INTEGER NOT NULL CHECK (level > 0),
	primitive TEXT NOT NULL,
	summary TEXT NOT NULL,                          -- what there is to say of the fit, as the API writes it
	sha256 BLOB NOT NULL CHECK (length(sha256) = 32),
	bytes BLOB NOT NULL,
	PRIMARY KEY (shape, level, primitive)
) STRICT;
