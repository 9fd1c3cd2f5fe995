/* eskel, the command line: reads what is asked, runs the command, says how it ended (complain.h). */
#include "cli/command.h"

#include <curl/curl.h>
#include <locale.h>
#include <string.h>

static esk_outcome run_command(int argc, char **argv)
{
	esk_arguments arguments;
	esk_outcome outcome = esk_arguments_parse(argc, argv, &arguments);
	if (outcome) {
		esk_arguments_clear(&arguments);
		return outcome;
	}
	if (esk_arguments_value(&arguments, "help")) {
		esk_arguments_write_help(arguments.command, stdout);
	} else {
		esk_session session = {.arguments = &arguments};
		outcome = esk_session_close(&session, arguments.command->run(&session));
	}
	esk_arguments_clear(&arguments);
	return outcome;
}

int main(int argc, char **argv)
{
	setlocale(LC_CTYPE, "");
	if (argc < 2) {
		esk_arguments_write_help(NULL, stderr);
		return ESK_MISUSED;
	}
	if (!strcmp(argv[1], "--help")) {
		esk_arguments_write_help(NULL, stdout);
		return ESK_DONE;
	}
	if (!strcmp(argv[1], "--version")) {
		puts("eskel " ESKEL_VERSION);
		return ESK_DONE;
	}
	curl_global_init(CURL_GLOBAL_DEFAULT);
	esk_outcome outcome = run_command(argc, argv);
	curl_global_cleanup();
	return (int)outcome;
}
