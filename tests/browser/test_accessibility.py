"""axe-core finds nothing to complain of in any page, at a desk and on a phone; in a real browser, without cameras.

`python -m pytest -s tests/browser/test_accessibility.py` prints what it looked at.
"""

from collections.abc import Iterator

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, expect

from mocapd.web.server import WebServer
from mocapd.wizard.step_names import StepName
from tests.browser.step_views import PAGES, SAVED, ShownWizard, check
from tests.browser.test_step_pages import SIZES, WAIT_MS
from tests.web.tiny_host import TinyHost


@pytest.fixture(scope="module")
def page(browser: Browser) -> Iterator[Page]:
    with browser.new_context(viewport=SIZES["desk"]) as context:
        yield context.new_page()


def violations(page: Page, name: str) -> list[str]:
    """Of every size and colour scheme, one line each."""
    found, rules = [], 0
    for size in SIZES.values():
        page.set_viewport_size(size)
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            told = Axe().run(page).response
            rules = len(told["passes"]) + len(told["violations"])
            found += [
                f"{name}, {scheme}, {size['width']} px: {one['id']}: {one['nodes'][0]['html'][:100]}"
                for one in told["violations"]
            ]
    print(f"{name}: {len(found)} violations of {rules} rules, twice in light and in dark")
    return found


@pytest.fixture(scope="module")
def steps(page: Page, server: WebServer, host: TinyHost) -> ShownWizard:
    """What the page shows of a setup, loaded once for all steps."""
    shown = ShownWizard()
    host.wizard = shown  # type: ignore[assignment]
    page.goto(server.url)
    return shown


@pytest.mark.parametrize("name", PAGES)
def test_steps(page: Page, steps: ShownWizard, name: str) -> None:
    step, view = PAGES[name]
    steps.show(step, view)
    page.locator(f"#part > .part-{step.value}").wait_for(timeout=WAIT_MS)
    expect(page.locator("#sentence")).to_have_text(view.sentence, timeout=WAIT_MS)
    assert violations(page, name) == []


def test_the_last_page_and_a_setup_that_is_none(
    page: Page, server: WebServer, host: TinyHost
) -> None:
    host.wizard = None
    page.goto(f"{server.url}#setup")
    expect(page.locator("#begin")).to_be_visible(timeout=WAIT_MS)
    assert violations(page, "no setup") == []
    shown = ShownWizard()
    shown.show(StepName.CHECK, check(saved=SAVED), saved=True)
    host.wizard = shown  # type: ignore[assignment]
    try:
        page.goto(f"{server.url}#setup")
        expect(page.locator("#finished")).to_be_visible(timeout=WAIT_MS)
        assert violations(page, "finished") == []
    finally:
        host.wizard = None


def test_the_live_view(page: Page, server: WebServer, host: TinyHost) -> None:
    for camera in ("cam0", "cam1"):
        host.show(camera, 120)
    page.goto(f"{server.url}#live")
    expect(page.locator("#tracking")).to_have_text("Tracking", timeout=WAIT_MS)
    expect(page.locator("#live-outputs")).to_contain_text("osc", timeout=WAIT_MS)
    assert violations(page, "live view") == []
