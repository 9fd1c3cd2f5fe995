#include "client.h"

#include <curl/curl.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct esk_client {
	CURL *curl;
	struct curl_slist *headers;
	char *server;
	esk_progress *progress;
	uint64_t rows; /* of the answer, that came so far */
	char complaint[512];
	bool listening; /* to lines, which say how far things are */
};

/* Where the body of an answer goes. */
typedef struct {
	esk_client *client;
	FILE *body;
	bool download;    /* a success goes to the file in place of body */
	const char *path; /* NULL: standard output */
	FILE *file;
	int error;
	void (*line)(void *context, const char *line); /* or NULL: shown the lines of a success */
	void *context;
	size_t length;
	char text[1 << 13]; /* the line that comes; what is longer is cut */
} sink;

static const long connect_seconds = 10;
enum { longest_token = 512 };

static esk_outcome complain(esk_client *client, esk_outcome outcome, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

static esk_outcome complain(esk_client *client, esk_outcome outcome, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(client->complaint, sizeof client->complaint, format, arguments);
	va_end(arguments);
	return client->progress ? esk_complain(outcome, "%s", client->complaint) : outcome;
}

const char *esk_client_complaint(const esk_client *client)
{
	return client->complaint;
}

/* The first line of the file, of printable ASCII. */
static esk_outcome read_token(const char *path, char token[longest_token])
{
	FILE *file = fopen(path, "re");
	if (!file)
		return esk_complain(ESK_MISUSED, "%s: %s", path, strerror(errno));
	bool read = fgets(token, longest_token, file);
	fclose(file);
	size_t length = read ? strcspn(token, "\r\n") : 0;
	token[length] = '\0';
	for (size_t i = 0; i < length; i++) {
		if (token[i] <= ' ' || token[i] > '~')
			length = 0;
	}
	return length > 0 ? ESK_DONE : esk_complain(ESK_MISUSED, "%s: its first line is not a token", path);
}

/* A proxy meant for other hosts cannot reach a server on this one. */
static bool is_loopback(const char *server)
{
	CURLU *url = curl_url();
	char *host = NULL;
	bool loopback = url && !curl_url_set(url, CURLUPART_URL, server, CURLU_GUESS_SCHEME) &&
			!curl_url_get(url, CURLUPART_HOST, &host, 0) &&
			(!strcmp(host, "localhost") || !strncmp(host, "127.", 4) || !strcmp(host, "[::1]"));
	curl_free(host);
	curl_url_cleanup(url);
	return loopback;
}

static esk_outcome authorize(CURL *curl, const char *token_file)
{
	char token[longest_token];
	esk_outcome outcome = read_token(token_file, token);
	if (outcome)
		return outcome;
	curl_easy_setopt(curl, CURLOPT_HTTPAUTH, (long)CURLAUTH_BEARER);
	curl_easy_setopt(curl, CURLOPT_XOAUTH2_BEARER, token);
	explicit_bzero(token, sizeof token);
	return ESK_DONE;
}

static int report_progress(void *context, curl_off_t down_total, curl_off_t down, curl_off_t up_total, curl_off_t up)
{
	esk_client *client = context;
	struct curl_header *header;
	if (!client->progress || client->listening)
		return 0;
	if (client->rows > 0 && !curl_easy_header(client->curl, "Eskel-Rows", 0, CURLH_HEADER, -1, &header)) {
		const uint64_t total = strtoull(header->value, NULL, 10);
		const double share = down_total > 0 ? (double)down / (double)down_total : 0;
		const uint64_t rows = down_total > 0 ? (uint64_t)(share * (double)total) : client->rows;
		esk_progress_received(client->progress, rows < total ? rows : total, total);
	} else {
		esk_progress_sent(client->progress, (uint64_t)up, (uint64_t)up_total);
	}
	return 0;
}

/* Rows are lines, but in formats whose size is known ahead. */
static void count_rows(esk_client *client, const char *bytes, size_t size)
{
	for (const char *end = bytes + size; (bytes = memchr(bytes, '\n', (size_t)(end - bytes))); bytes++)
		client->rows++;
	if (client->rows == 0)
		client->rows = 1;
}

static size_t take_lines(sink *s, const char *bytes, size_t size)
{
	for (size_t i = 0; i < size; i++) {
		if (bytes[i] == '\n') {
			s->text[s->length] = '\0';
			s->length = 0;
			s->line(s->context, s->text);
		} else if (s->length + 1 < sizeof s->text) {
			s->text[s->length++] = bytes[i];
		}
	}
	return size;
}

static size_t take_body(char *bytes, size_t one, size_t size, void *context)
{
	(void)one;
	sink *s = context;
	long status = 0;
	curl_easy_getinfo(s->client->curl, CURLINFO_RESPONSE_CODE, &status);
	const bool success = status >= 200 && status < 300;
	if (success && s->line)
		return take_lines(s, bytes, size);
	if (!success || !s->download)
		return fwrite(bytes, 1, size, s->body);
	if (!s->file)
		s->file = s->path ? fopen(s->path, "we") : stdout;
	count_rows(s->client, bytes, size);
	if (s->file && fwrite(bytes, 1, size, s->file) == size)
		return size;
	s->error = errno;
	return CURL_WRITEFUNC_ERROR;
}

esk_outcome esk_client_new(const char *server, const char *token_file, esk_progress *progress, esk_client **client)
{
	esk_client *made = calloc(1, sizeof *made);
	esk_outcome outcome = ESK_DONE;
	if (made)
		*made = (esk_client){.curl = curl_easy_init(),
			.headers = curl_slist_append(NULL, "Content-Type: application/octet-stream"),
			.server = strdup(server),
			.progress = progress};
	/* "http://host/" and "http://host" are the same server. */
	for (size_t n = made && made->server ? strlen(made->server) : 0; n > 0 && made->server[n - 1] == '/'; n--)
		made->server[n - 1] = '\0';
	if (!made || !made->curl || !made->headers || !made->server) {
		outcome = esk_complain(ESK_REFUSED, "memory ran out");
		goto cleanup;
	}
	curl_easy_setopt(made->curl, CURLOPT_PROTOCOLS_STR, "http,https");
	curl_easy_setopt(made->curl, CURLOPT_CONNECTTIMEOUT, connect_seconds);
	curl_easy_setopt(made->curl, CURLOPT_USERAGENT, "eskel");
	curl_easy_setopt(made->curl, CURLOPT_NOSIGNAL, 1L);
	curl_easy_setopt(made->curl, CURLOPT_NOPROGRESS, 0L);
	curl_easy_setopt(made->curl, CURLOPT_XFERINFOFUNCTION, report_progress);
	curl_easy_setopt(made->curl, CURLOPT_XFERINFODATA, made);
	curl_easy_setopt(made->curl, CURLOPT_WRITEFUNCTION, take_body);
	if (is_loopback(server))
		curl_easy_setopt(made->curl, CURLOPT_PROXY, "");
	if (token_file)
		outcome = authorize(made->curl, token_file);
cleanup:
	if (outcome)
		esk_client_free(made);
	else
		*client = made;
	return outcome;
}

void esk_client_free(esk_client *client)
{
	if (!client)
		return;
	curl_easy_cleanup(client->curl);
	curl_slist_free_all(client->headers);
	free(client->server);
	free(client);
}

static int seek_file(void *file, curl_off_t offset, int origin)
{
	return fseeko(file, offset, origin) ? CURL_SEEKFUNC_CANTSEEK : CURL_SEEKFUNC_OK;
}

/* A file's size is announced; what is no file (a pipe) is sent in chunks. */
static esk_outcome prepare_upload(esk_client *client, const char *path, FILE **file)
{
	struct stat status;
	CURL *curl = client->curl;
	FILE *opened = fopen(path, "re");
	if (!opened)
		return complain(client, ESK_MISUSED, "%s: %s", path, strerror(errno));
	if (fstat(fileno(opened), &status) || S_ISDIR(status.st_mode)) {
		fclose(opened);
		return complain(client, ESK_MISUSED, "%s: it is not a file", path);
	}
	curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
	curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, "POST");
	curl_easy_setopt(curl, CURLOPT_READDATA, opened);
	curl_easy_setopt(curl, CURLOPT_SEEKFUNCTION, seek_file);
	curl_easy_setopt(curl, CURLOPT_SEEKDATA, opened);
	curl_easy_setopt(curl, CURLOPT_INFILESIZE_LARGE, (curl_off_t)(S_ISREG(status.st_mode) ? status.st_size : -1));
	*file = opened;
	return ESK_DONE;
}

static void prepare_download(CURL *curl, const char *method)
{
	curl_easy_setopt(curl, CURLOPT_UPLOAD, 0L);
	curl_easy_setopt(curl, CURLOPT_HTTPGET, 1L);
	curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method);
}

static esk_outcome explain(esk_client *client, const sink *s, const char *reason)
{
	const char *path = s->path ? s->path : "standard output";
	if (s->error)
		return complain(client, ESK_REFUSED, "%s: %s", path, strerror(s->error));
	if (s->file)
		return complain(
			client, ESK_UNREACHABLE, "%s is not whole: %s broke off: %s", path, client->server, reason);
	return complain(client, ESK_UNREACHABLE, "%s does not answer: %s", client->server, reason);
}

static esk_outcome perform(esk_client *client, const esk_request *request, sink *s)
{
	char *url = NULL, reason[CURL_ERROR_SIZE] = "";
	const char *query = request->query[0] ? request->query + 1 : "";
	if (asprintf(&url, "%s%s%s%s", client->server, request->path, *query ? "?" : "", query) < 0)
		return complain(client, ESK_REFUSED, "memory ran out");
	client->rows = 0;
	client->listening = s->line;
	curl_easy_setopt(client->curl, CURLOPT_URL, url);
	curl_easy_setopt(client->curl, CURLOPT_HTTPHEADER, request->file ? client->headers : NULL);
	curl_easy_setopt(client->curl, CURLOPT_WRITEDATA, s);
	curl_easy_setopt(client->curl, CURLOPT_ERRORBUFFER, reason);
	CURLcode code = curl_easy_perform(client->curl);
	curl_easy_setopt(client->curl, CURLOPT_ERRORBUFFER, NULL);
	if (client->progress)
		esk_progress_end(client->progress, !code);
	free(url);
	return code ? explain(client, s, *reason ? reason : curl_easy_strerror(code)) : ESK_DONE;
}

/* 0 without the header. */
static long header_number(CURL *curl, const char *name)
{
	struct curl_header *header;
	return curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &header) ? 0 : strtol(header->value, NULL, 10);
}

/* The name that the file is given says so. */
static bool has_weights(CURL *curl)
{
	struct curl_header *header;
	return !curl_easy_header(curl, "Content-Disposition", 0, CURLH_HEADER, -1, &header) &&
	       strstr(header->value, ".weights.");
}

/* Sends the request and takes the answer's body where the sink says. */
static esk_outcome transfer(esk_client *client, const esk_request *request, sink *s, esk_answer *answer)
{
	FILE *file = NULL;
	esk_answer got = {0};
	s->client = client;
	s->body = open_memstream(&got.body, &got.size);
	if (!s->body)
		return complain(client, ESK_REFUSED, "memory ran out");
	esk_outcome outcome = ESK_DONE;
	if (request->file)
		outcome = prepare_upload(client, request->file, &file);
	else
		prepare_download(client->curl, request->method);
	if (!outcome)
		outcome = perform(client, request, s);
	if (file)
		fclose(file);
	if (fclose(s->body) && !outcome)
		outcome = complain(client, ESK_REFUSED, "memory ran out");
	if (outcome) {
		free(got.body);
		return outcome;
	}
	curl_easy_getinfo(client->curl, CURLINFO_RESPONSE_CODE, &got.status);
	got.retry_after = header_number(client->curl, "Retry-After");
	got.added = (size_t)header_number(client->curl, "Eskel-Added");
	got.weights = has_weights(client->curl);
	*answer = got;
	return ESK_DONE;
}

long esk_answer_wait(const esk_answer *answer)
{
	if (answer->status != 429 && answer->status != 503)
		return 0;
	return answer->retry_after > 0 ? answer->retry_after : 1;
}

esk_outcome esk_client_send(esk_client *client, const esk_request *request, esk_answer *answer)
{
	sink s = {0};
	return transfer(client, request, &s, answer);
}

esk_outcome esk_client_download(esk_client *client, const esk_request *request, const char *path, esk_answer *answer)
{
	sink s = {.download = true, .path = path};
	esk_answer got = {0};
	esk_outcome outcome = transfer(client, request, &s, &got);
	if (s.file && s.file != stdout && fclose(s.file) && !outcome)
		outcome = complain(client, ESK_REFUSED, "%s: %s", path, strerror(errno));
	if (outcome)
		free(got.body);
	else
		*answer = got;
	return outcome;
}

esk_outcome esk_client_listen(esk_client *client, const esk_request *request,
	void (*line)(void *context, const char *line), void *context, esk_answer *answer)
{
	sink s = {.line = line, .context = context};
	return transfer(client, request, &s, answer);
}
