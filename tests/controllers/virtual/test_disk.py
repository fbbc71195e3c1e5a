"""The virtual controller's disk: nothing leaves it, nothing overfills it."""

import json

import pytest

from mitl.controllers.virtual import files


@pytest.mark.parametrize(
    "path",
    [
        "../secret",
        "HOME/../../secret",
        "HOME/%2e%2e/%2e%2e/secret",
        "$home/..%2f..%2fsecret",
        "HOME/..%5c..%5csecret",
        "/etc/passwd",
        "HOME/link/secret",
        "HOME/a%00b",
    ],
)
@pytest.mark.parametrize("method", ["GET", "PUT", "DELETE"])
def test_no_path_leaves_the_disk(make, tmp_path, method, path):
    _, client = make("1")
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "disk" / "HOME" / "link").symlink_to(tmp_path)
    answer = client(method, f"/fileservice/{path}", body=b"overwritten")
    assert answer.status in (400, 403, 404)
    assert (tmp_path / "secret").read_text() == "secret"


def test_a_copied_folder_takes_nothing_from_where_its_links_lead(make, tmp_path):
    _, client = make("1")
    (tmp_path / "secret").write_text("secret")
    folder = tmp_path / "disk" / "HOME" / "a"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path / "secret")
    client("POST", "/fileservice/HOME/a", {"fs-action": "copy", "fs-newname": "b"})
    assert client("GET", "/fileservice/HOME/b/link").status == 403
    assert (tmp_path / "disk" / "HOME" / "b" / "link").is_symlink()


def test_copies_cannot_fill_more_than_the_disk_holds(make, monkeypatch):
    monkeypatch.setattr(files, "MOST_BYTES", 3000)
    _, client = make("1")
    client("PUT", "/fileservice/HOME/a", body=bytes(1400))
    statuses = [client("POST", "/fileservice/HOME/a", {"fs-action": "copy", "fs-newname": f"b{i}"}).status for i in range(2)]
    assert statuses == [204, 507]


def test_a_volume_itself_cannot_be_removed(make):
    _, client = make("1")
    assert client("DELETE", "/fileservice/$HOME").status == 403
    assert client("DELETE", "/fileservice/").status == 403


def test_folders_are_made_files_copied_renamed_and_listed(make):
    _, client = make("1")
    client("PUT", "/fileservice/$home/a.txt", body=b"hello")
    assert client("POST", "/fileservice/$home", {"fs-action": "create", "fs-newname": "sub"}).status == 201
    assert client("POST", "/fileservice/$home/a.txt", {"fs-action": "copy", "fs-newname": "$home/sub/b.txt"}).status == 204
    assert client("POST", "/fileservice/$home/a.txt", {"fs-action": "rename", "fs-newname": "c.txt"}).status == 204
    listing = json.loads(client("GET", "/fileservice/$home").body)["_embedded"]["_state"]
    assert [(item["_type"], item["_title"]) for item in listing] == [("fs-file", "c.txt"), ("fs-dir", "sub")]
    assert client("GET", "/fileservice/$home/sub/b.txt").body == b"hello"
