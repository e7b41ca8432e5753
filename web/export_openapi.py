"""Writes `web/openapi.json`, from which the console's API client is generated.

    python web/export_openapi.py           writes it
    python web/export_openapi.py --check   exits 1 if the committed one is not what the service says today

The document is committed, because the console is built where the service's own dependencies are not installed.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from server.app import create_app
from server.settings import Settings

API_VERSION = "v1"
"""In place of the release, which would make the document old with every one."""

DOCUMENT = Path(__file__).with_name("openapi.json")


def openapi_document() -> str:
    """The service's OpenAPI document as it is committed: sorted, so that a difference is a change of the API."""
    document = create_app(Settings()).openapi()
    document["info"]["version"] = API_VERSION
    return json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def main() -> int:
    """Write or check the document; the exit code says whether it was up to date or written."""
    parser = argparse.ArgumentParser(description="Writes web/openapi.json, the API as it is committed.")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if it is out of date")
    check = parser.parse_args().check
    current = openapi_document()
    if not check:
        DOCUMENT.write_text(current, encoding="utf-8")
        return 0
    if DOCUMENT.exists() and DOCUMENT.read_text(encoding="utf-8") == current:
        return 0
    print("web/openapi.json is out of date; run: python web/export_openapi.py", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
