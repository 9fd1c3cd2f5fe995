#!/usr/bin/python3
"""Holds every answer that the API's tests get against openapi.yaml: check_answers.py openapi.yaml TEST...

Each answer's status must be described for its route, and its body must fit the schema. The examples must fit as well,
and every schema of an answer must have been met by an answer of the tests."""
import json
import os
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

BY_THE_SERVER = {"/", "/metrics"}  # not routes of the API


def resolve(document, value):
    while "$ref" in value:
        place = document
        for name in value["$ref"].removeprefix("#/").split("/"):
            place = place[name]
        value = place
    return value


class Description:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.document = json.loads(json.dumps(yaml.safe_load(file)))
        self.met = set()

    def check(self, schema, body):
        # The document is the schema's root, so that its references can be followed.
        root = {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema,
                "components": self.document["components"]}
        jsonschema.Draft202012Validator(root).validate(body)

    def response(self, route, method, status):
        operation = self.document["paths"][route].get(method.lower())
        if operation is None:
            return None
        responses = operation["responses"]
        return resolve(self.document, responses.get(str(status), responses["default"]))

    def check_answer(self, answer):
        method = "GET" if answer["method"] == "HEAD" else answer["method"]
        status, content_type = answer["status"], answer["type"]
        response = self.response(answer["route"], method, status) if answer["route"] else None
        if response is None:  # 404 without a route, 405 and OPTIONS without an operation
            assert status in (204, 404, 405), "the status is not described"
            if status != 204:
                self.check({"$ref": "#/components/schemas/Problem"}, answer["body"])
            return
        if str(status) not in self.document["paths"][answer["route"]][method.lower()]["responses"]:
            raise AssertionError("the status is not described")
        self.met.add((answer["route"], method, str(status)))
        if content_type is None:
            assert "content" not in response, "a body is described"
            return
        described = response["content"][content_type.partition(";")[0]]
        if content_type.partition(";")[0].endswith("json"):
            self.check(described["schema"], answer["body"])

    def check_examples(self):
        for path, item in self.document["paths"].items():
            for method, operation in item.items():
                if method == "parameters":
                    continue
                for status, response in operation["responses"].items():
                    for described in resolve(self.document, response).get("content", {}).values():
                        if "example" in described:
                            self.check(described["schema"], described["example"])

    def unmet(self):
        """Successes of the API's own routes that no test got."""
        for path, item in self.document["paths"].items():
            for method, operation in item.items():
                for status in operation["responses"] if method != "parameters" else ():
                    if status < "400" and path not in BY_THE_SERVER and (path, method.upper(), status) not in self.met:
                        yield f"{method.upper()} {path} {status}"


def main(description_path, tests):
    description = Description(description_path)
    description.check_examples()
    failures = count = 0
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, "answers")
        for test in tests:
            subprocess.run([test], env={**os.environ, "ESKEL_ANSWERS": log}, check=True, capture_output=True)
        with open(log, encoding="utf-8") as file:
            for line in file:
                count += 1
                answer = json.loads(line)
                try:
                    description.check_answer(answer)
                except (AssertionError, KeyError, jsonschema.ValidationError) as error:
                    failures += 1
                    print(f"{answer['method']} {answer['target'][:120]} {answer['status']}: {error}\n")
    for missing in description.unmet():
        failures += 1
        print(f"no test gets {missing}")
    print(f"{count} answers, {failures} failures")
    return failures > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
