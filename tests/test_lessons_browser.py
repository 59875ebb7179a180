"""A lesson in a real browser, from disk and with the network off: its sliders and its answers."""

import pytest
from browser import chromium
from playwright.sync_api import sync_playwright

from crankmbs.lessons import write_lesson


@pytest.fixture
def opened(tmp_path):
    """The page of the first lesson at slide size, with all it asked for and complained about."""
    file = write_lesson("displacement", tmp_path)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        context = browser.new_context(viewport={"width": 1280, "height": 800}, offline=True)
        page = context.new_page()
        requests, complaints = [], []
        page.on("request", lambda request: requests.append(request.url))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("console", lambda message: complaints.append(message.text))
        page.goto(file.as_uri())
        yield page
        browser.close()
    assert requests == [file.as_uri()]
    assert complaints == []


def test_a_slider_shows_its_frame_and_an_answer_opens_on_a_click(opened):
    figure = opened.locator("figure").first
    slider, frames = figure.locator("input"), figure.locator(".frame")
    marks = slider.get_attribute("data-marks").split("|")
    for k in (len(marks) - 1, 0):
        slider.focus()
        opened.keyboard.press("End" if k else "Home")
        assert [frames.nth(i).is_visible() for i in range(len(marks))] == [
            i == k for i in range(len(marks))
        ]
        assert figure.locator("output").inner_text() == marks[k]
    answer = opened.locator("details").first
    assert not answer.locator("p").is_visible()
    answer.locator("summary").click()
    assert answer.locator("p").is_visible()
    assert "5.8359" in answer.locator("#brix_simulated").inner_text()


def test_figures_and_formulas_fit_the_page(opened):
    width = opened.evaluate("document.documentElement.clientWidth")
    assert opened.evaluate("document.documentElement.scrollWidth") == width
    for box in opened.locator(".formula").all():
        formula = box.locator("math").bounding_box()
        around = box.bounding_box()
        assert 15.0 < formula["height"] < 80.0  # built up, and not one line of letters
        assert formula["x"] + formula["width"] <= around["x"] + around["width"]
