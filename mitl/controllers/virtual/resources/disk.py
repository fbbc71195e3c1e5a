"""/fileservice: the controller's disk."""

from __future__ import annotations

from mitl.controllers.virtual.answers import DONE, Answer, Dialect, Item, invalid
from mitl.controllers.virtual.files import FileService
from mitl.controllers.virtual.router import ALL, RWS1, RWS2, Call, Route


class DiskResources:
    """Files and folders."""

    def __init__(self, files: FileService) -> None:
        self._files = files

    def routes(self) -> list[Route]:
        """Gives the table."""
        return [
            Route("POST", "fileservice/{path*}", self.post2, RWS2),
            Route("GET", "fileservice/{path*}", self.get, ALL),
            Route("PUT", "fileservice/{path*}", self.put, ALL),
            Route("DELETE", "fileservice/{path*}", self.delete, ALL),
            Route("POST", "fileservice/{path*}", self.post, RWS1),
        ]

    def get(self, call: Call) -> Answer:
        """A file's bytes, or what is in a folder."""
        address = call.names["path"]
        content = self._files.read(address)
        if content is not None:
            return Answer(200, raw=content)
        return Answer(
            200,
            tuple(
                Item(
                    "fs-dir" if entry.folder else "fs-file",
                    entry.name,
                    {
                        "fs-cdate": entry.changed.strftime("%Y-%m-%d T %H:%M:%S"),
                        "fs-mdate": entry.changed.strftime("%Y-%m-%d T %H:%M:%S"),
                        **({} if entry.folder else {"fs-size": str(entry.size), "fs-readonly": "false"}),
                    },
                    entry.name,
                )
                for entry in self._files.listing(address)
            ),
        )

    def put(self, call: Call) -> Answer:
        """Writes a file."""
        return Answer(201 if self._files.write(call.names["path"], call.body) else 200, ())

    def delete(self, call: Call) -> Answer:
        """Removes a file or folder."""
        self._files.remove(call.names["path"])
        return DONE if call.dialect is not Dialect.RWS1 else Answer(200, ())

    def post(self, call: Call) -> Answer:
        """Makes, copies or renames, 1.0."""
        return self._act(call, call.names["path"], call.wanted("fs-action"))

    def post2(self, call: Call) -> Answer:
        """Makes, copies or renames, 2.0."""
        address, _, verb = call.names["path"].rpartition("/")
        return self._act(call, address, verb)

    def _act(self, call: Call, address: str, verb: str) -> Answer:
        name = call.wanted("fs-newname")
        match verb:
            case "create":
                self._files.make_folder(address, name)
                return Answer(201, ())
            case "copy" | "rename":
                self._files.copy(address, name, move=verb == "rename")
                return DONE
            case _:
                raise invalid(f"expected create, copy or rename, got {verb!r}")
