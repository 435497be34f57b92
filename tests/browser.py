"""A real browser for the tests of pages: Chromium without a window, driven by Selenium.

Where one of them is missing the tests skip, and say what to install.

On Debian: `apt-get install chromium chromium-driver`. The browser is given no network: a page that asks for anything
gets nothing, and its console says so.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

PHONE, DESKTOP = (390, 844), (1280, 900)


@contextmanager
def browser() -> Iterator[object]:
    """A driver; the pages it opens are files."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium (pip install selenium)")
    program, driver = shutil.which("chromium") or shutil.which("google-chrome"), shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip("needs a browser: apt-get install chromium chromium-driver")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    switches = ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage", "hide-scrollbars",
                "host-resolver-rules=MAP * ~NOTFOUND", "disable-background-networking")  # fmt: skip
    for switch in switches:
        options.add_argument(f"--{switch}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    failure = pytest.importorskip("selenium.common.exceptions").WebDriverException
    try:
        window = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    except failure as error:
        pytest.skip(f"the browser does not start here: {str(error).splitlines()[0]}")
    try:
        yield window
    finally:
        window.quit()


def opened(window: object, page: Path, size: tuple[int, int]) -> None:
    """Open a page at this size; it must not fail, ask for anything, or be wider than the window."""
    metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600}
    window.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)  # type: ignore[attr-defined]
    window.get(page.absolute().as_uri())  # type: ignore[attr-defined]
    sound(window)


def sound(window: object) -> None:
    """No error in the console, nothing loaded, no part of the page beyond the window's width."""
    said = [entry["message"] for entry in window.get_log("browser") if "favicon" not in entry["message"]]  # type: ignore[attr-defined]
    assert not said, said
    script = window.execute_script  # type: ignore[attr-defined]
    assert script("return performance.getEntriesByType('resource').length") == 0
    assert script("return document.documentElement.scrollWidth <= window.innerWidth")
