"""Records come back as they were appended, whole blocks once and for all, also while another thread appends."""

import threading

from mitl.trackers.sample_store import SampleStore


def records(count, first=0):
    return [number.to_bytes(4, "little") for number in range(first, first + count)]


def test_blocks_and_the_rest_are_all_that_was_appended_in_order():
    store = SampleStore(4)
    assert store.blocks() == ([], b"")
    assert store.last() == b""
    for record in records(2500):
        store.append(record)
        assert store.last() == record
    full, newest = store.blocks()
    assert b"".join([*full, newest]) == b"".join(records(2500))
    assert [len(block) for block in full] == [4000, 4000]
    assert store.blocks(after=1)[0] == full[1:]


def test_the_last_record_is_known_where_a_block_is_just_full():
    store = SampleStore(4)
    for record in records(1000):
        store.append(record)
    assert store.blocks()[1] == b""
    assert store.last() == records(1000)[-1]


def test_a_reader_sees_a_beginning_of_what_a_writer_appends():
    store = SampleStore(4)
    whole = records(20_000)
    writer = threading.Thread(target=lambda: [store.append(record) for record in whole])
    writer.start()
    joined, seen = b"".join(whole), 0
    while seen < len(joined):
        full, newest = store.blocks()
        content = b"".join([*full, newest])
        assert joined.startswith(content)
        assert len(content) >= seen
        seen = len(content)
    writer.join()
