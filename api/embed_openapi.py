"""Makes openapi.yaml compact JSON, NUL-terminated, in a C header: embed_openapi.py openapi.yaml OUTPUT.h"""
import json
import sys

import yaml

source, output = sys.argv[1:]
with open(source, encoding="utf-8") as file:
    text = json.dumps(yaml.safe_load(file), ensure_ascii=False, separators=(",", ":"))
data = text.encode("utf-8") + b"\0"
with open(output, "w", encoding="ascii") as file:
    file.write("static const unsigned char openapi_json[] = {\n")
    for start in range(0, len(data), 24):
        file.write(",".join(map(str, data[start : start + 24])) + ",\n")
    file.write("};\n")
