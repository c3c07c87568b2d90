"""The page that a report is, in a real browser without a network."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.reporting import Report
from robustness.reporting.front import report_of
from robustness.reporting.section import Section
from robustness.surveying import Row, Survey
from robustness.threat_models import THREAT_MODELS
from tests.test_report import NASTY, networks

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def made() -> Report:
    return rb.report(networks(), gate=rb.Gate(survive=1), title="Fleet " + NASTY)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Debian's Chromium without a network, or a reason to skip."""
    selenium = pytest.importorskip("selenium.webdriver")
    binary, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if binary is None or driver is None:
        pytest.skip("no chromium and chromedriver on the PATH: the page is not tried in a browser")
    options = selenium.ChromeOptions()
    options.binary_location = binary
    for flag in ("headless=new", "no-sandbox", "disable-gpu", "disable-quic", "disable-background-networking"):
        options.add_argument(f"--{flag}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    opened = selenium.Chrome(options=options, service=selenium.ChromeService(driver))
    opened.execute_cdp_cmd("Network.enable", {})
    opened.execute_cdp_cmd(
        "Network.emulateNetworkConditions",
        {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0},
    )
    yield opened
    opened.quit()


class TestBoundsInABrowser:
    """Rows that are not known whole: what is chosen is certain."""

    ROWS = (
        Row("a/exact", nodes=9, arcs=1, r=2, r_at_most=2),
        Row("a/interval", nodes=9, arcs=1, r=2, r_at_most=4),
        Row("b/open", nodes=9, arcs=1, r=2),
        Row("b/unknown", nodes=9, arcs=1),
        Row("b/unreadable", error="no such file"),
    )

    @pytest.fixture
    def page(self, browser: Any, tmp_path: Path) -> Any:
        target = tmp_path / "report.html"
        report_of(Survey(self.ROWS, ()), {}).write(target)
        browser.get(target.as_uri())
        browser.find_element("css selector", ".filters summary").click()
        yield browser
        assert [entry["message"] for entry in browser.get_log("browser")] == []

    @pytest.mark.parametrize(
        ("end", "value", "shown"),
        [
            ("least", "2", ["a/exact", "a/interval", "b/open"]),
            ("least", "3", []),
            ("most", "3", ["a/exact"]),
            ("most", "4", ["a/exact", "a/interval"]),
        ],
    )
    def test_an_interval_is_chosen_when_all_of_it_lies_within(
        self, page: Any, end: str, value: str, shown: list[str]
    ) -> None:
        page.find_element("css selector", f"input[aria-label='r*: at {end}']").send_keys(value)
        assert TestInABrowser.names(page) == shown

    def test_a_collection_is_chosen(self, page: Any) -> None:
        page.find_element("css selector", "#group option:nth-child(2)").click()
        assert TestInABrowser.names(page) == ["a/exact", "a/interval"]

    @pytest.mark.parametrize(("width", "medium"), [(1280, "screen"), (720, "print")])
    def test_a_name_of_usual_length_is_not_cut_into_lines(
        self, width: int, medium: str, browser: Any, tmp_path: Path
    ) -> None:
        counts = dict.fromkeys(THREAT_MODELS, 0)
        row = Row("topohub:sndlib/pioro40", 40, 178, False, 1, 1, 6, 6, counts, counts, "refuted", seconds=5.1)
        rows = [replace(row, links=17, links_at_least=3), Row("broken.json", error="no such file as this one " * 3)]
        target = tmp_path / "wide.html"
        picture = b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 2 1'/>"
        report_of(Survey(tuple(rows), tuple(THREAT_MODELS)), {row.network: Section(picture)}).write(target)
        browser.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
        )
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": medium})
        browser.get(target.as_uri())
        lines = "return arguments[0].getClientRects().length"
        link = browser.find_element("css selector", "td.name a")
        told = link.text, browser.execute_script(lines, link), browser.find_element("css selector", "main").text
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        assert told[:2] == (row.network, 1)
        assert "3..5 when 5 were found" in told[2]

    def test_seconds_that_nobody_kept_have_no_column(self, page: Any) -> None:
        heads = [each.text for each in page.find_elements("css selector", "th")]
        assert heads == ["network", "nodes", "arcs", "r*", "s", "comment"]


class TestInABrowser:
    @pytest.fixture
    def page(self, browser: Any, made: Report, tmp_path: Path) -> Any:
        target = tmp_path / "report.html"
        made.write(target)
        browser.set_window_size(1100, 900)
        browser.get(target.as_uri())
        yield browser
        assert browser.title == "Fleet " + NASTY
        assert [entry["message"] for entry in browser.get_log("browser")] == []

    @staticmethod
    def names(page: Any) -> list[str]:
        cells = page.find_elements("css selector", "table.networks tbody td.name")
        return [cell.text for cell in cells if cell.is_displayed()]

    def test_sorting(self, page: Any) -> None:
        head = page.find_elements("css selector", "table.networks th button")
        by_name = {button.text.split()[0]: button for button in head}
        by_name["nodes"].click()
        assert [name.split("<")[0] for name in self.names(page)] == ["one", "wheel", "complete", "path"]
        by_name["nodes"].click()
        assert [name.split("<")[0] for name in self.names(page)] == ["path", "complete", "wheel", "one"]
        sorted_head = page.find_element("css selector", "th[aria-sort]")
        assert sorted_head.get_attribute("aria-sort") == "descending"

    def test_finding(self, page: Any) -> None:
        page.find_element("css selector", "#words").send_keys("compl")
        assert self.names(page) == ["complete"]
        assert page.find_element("css selector", "#count").text == "1 of 4 shown"

    def test_bounds_choose_rows_and_clear_shows_all_again(self, page: Any) -> None:
        page.find_element("css selector", ".filters summary").click()
        least = page.find_element("css selector", "input[aria-label='nodes: at least']")
        least.send_keys("6")
        assert self.names(page) == ["complete", "path"]
        page.find_element("css selector", "input[aria-label='r*: at most']").send_keys("1")
        assert self.names(page) == ["path"]
        assert page.find_element("css selector", "#count").text == "1 of 4 shown"
        page.find_element("css selector", "#clear").click()
        assert len(self.names(page)) == 4
        assert least.get_attribute("value") == ""

    def test_only_what_does_not_pass(self, page: Any) -> None:
        page.find_element("css selector", "#failing").click()
        assert [name.split("<")[0] for name in self.names(page)] == ["wheel", "path"]

    def test_a_name_opens_its_part(self, page: Any) -> None:
        page.find_element("link text", "complete").click()
        (part,) = [part for part in page.find_elements("css selector", "details.network") if part.get_attribute("open")]
        assert part.find_element("css selector", "h2").text == "complete"
        picture = part.find_element("css selector", "figure img")
        assert page.execute_script("return arguments[0].naturalWidth", picture) > 100

    def test_playing_and_pausing_with_the_keyboard(self, page: Any) -> None:
        page.execute_script("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
        film = page.find_element("css selector", ".film")
        button, slider = film.find_element("css selector", "button"), film.find_element("css selector", "input")
        curtain = film.find_element("css selector", ".shown")
        full = float(curtain.get_attribute("width"))
        button.send_keys(" ")
        assert button.text == "Pause"
        button.send_keys(" ")
        assert button.text == "Play"
        assert float(curtain.get_attribute("width")) < full
        slider.send_keys("\ue010")  # End
        assert float(curtain.get_attribute("width")) == full

    def test_a_narrow_screen_does_not_scroll_sideways(self, page: Any) -> None:
        page.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride", {"width": 360, "height": 740, "deviceScaleFactor": 1, "mobile": True}
        )
        page.execute_script("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
        assert page.execute_script("return document.documentElement.scrollWidth") <= 360
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    @pytest.mark.parametrize(("width", "medium"), [(1280, "screen"), (1024, "screen"), (700, "print")])
    def test_the_verdict_of_every_network_is_in_sight(self, page: Any, width: int, medium: str) -> None:
        page.execute_cdp_cmd(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
        )
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": medium})
        wide = "return arguments[0].getBoundingClientRect().right"
        cells = page.find_elements("css selector", "table.networks td.passed, table.networks td.refuted")
        assert len(cells) == 4
        assert max(page.execute_script(wide, cell) for cell in cells) < width / 2
        if width != 1024:  # nothing else is cut off either
            assert page.execute_script(wide, page.find_element("css selector", "table.networks")) <= width
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    def test_a_part_says_how_its_network_stands_and_what_it_survives(self, page: Any) -> None:
        parts = page.find_elements("css selector", "details.network")
        assert [part.find_element("css selector", ".standing").text for part in parts] == [
            "refuted", "passed", "refuted", "passed"
        ]  # fmt: skip
        page.find_element("link text", "complete").click()
        numbers = [
            [each.text for each in line.find_elements("css selector", "td")]
            for line in parts[1].find_elements("css selector", "table.models tbody tr")
        ]
        known = rb.tolerance(nx.complete_graph(7))
        assert numbers == [[str(result.guaranteed), str(result.refuted)] for result in known.results]

    @pytest.mark.parametrize("scheme", ["light", "dark"])
    def test_letters_stand_out_from_the_ground(self, page: Any, scheme: str) -> None:
        page.execute_cdp_cmd(
            "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        )
        style = "getComputedStyle(document.querySelector('p.verdict'))"
        ink, ground = (
            sum(map(int, re.findall(r"\d+", page.execute_script(f"return {style}.{name}"))[:3]))
            for name in ("color", "backgroundColor")
        )
        assert abs(ink - ground) > 450
        assert (ground > 400) == (scheme == "light")
