/* eskeld, the daemon. */
#include "daemon/administer.h"
#include "daemon/options.h"
#include "daemon/serve.h"

int main(int argc, char **argv)
{
	esk_options options;
	switch (esk_options_parse(argc, argv, &options)) {
	case ESK_OPTIONS_RUN:
		return options.command == ESK_SERVE ? esk_serve(&options) : esk_administer(&options);
	case ESK_OPTIONS_DONE:
		return 0;
	case ESK_OPTIONS_WRONG:
		break;
	}
	return 2;
}
