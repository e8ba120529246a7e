"""The mailbox of depth one."""

import threading

from mocapd.pipeline.latest import Latest


def test_the_newest_wins_and_what_it_displaces_is_counted() -> None:
    box: Latest[int] = Latest()
    for item in (1, 2, 3):
        box.put(item)
    assert box.get(0.0) == 3
    assert box.get(0.0) is None
    assert box.dropped == 2


def test_a_falsy_item_is_an_item() -> None:
    box: Latest[int] = Latest()
    box.put(0)
    box.put(0)
    assert box.dropped == 1
    assert box.get(0.0) == 0


def test_get_waits_for_put() -> None:
    box: Latest[str] = Latest()
    got: list[str | None] = []
    reader = threading.Thread(target=lambda: got.append(box.get(10.0)))
    reader.start()
    box.put("here")
    reader.join(10.0)
    assert got == ["here"]


def test_close_wakes_every_waiter_and_ends_the_mailbox() -> None:
    box: Latest[int] = Latest()
    got: list[int | None] = []
    readers = [threading.Thread(target=lambda: got.append(box.get())) for _ in range(3)]
    for reader in readers:
        reader.start()
    box.close()
    for reader in readers:
        reader.join(10.0)
    assert got == [None] * 3
    box.put(1)
    assert box.get() is None
    assert box.closed
    assert box.dropped == 0


def test_nothing_is_lost_unless_counted() -> None:
    box: Latest[int] = Latest()
    n = 2_000
    got: list[int] = []

    def read() -> None:
        while (item := box.get(10.0)) is not None and item != n - 1:
            got.append(item)

    reader = threading.Thread(target=read)
    reader.start()
    for item in range(n):
        box.put(item)
    reader.join(10.0)
    assert got == sorted(set(got))
    assert len(got) + 1 + box.dropped == n
