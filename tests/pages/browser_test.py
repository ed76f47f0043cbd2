"""Drives pages of real runs in a headless Chromium: requests, slider, animation, zoom and sorting.

    python3 browser_test.py PROGRAM [TEST...]

Exit code 77 (skipped) if Chromium or Selenium is absent. With FLEXMORPH_PICTURES, a folder, pictures
of the page are written there: light, dark, on a phone and as PDF.
"""

import base64
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
except ImportError:
    print("Selenium is not installed")
    sys.exit(77)
CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
if not CHROMIUM or not DRIVER:
    print("Chromium or its driver is not installed")
    sys.exit(77)

PROGRAM = sys.argv.pop(1)
PICTURES = os.environ.get("FLEXMORPH_PICTURES")
CHANGES = ["expect=", "time.end=0.2", "time.step=2e-3", "optimizer.max_iterations=12",
           "design.cell=0.01", "design.min_thickness=0.01", "esl.every=0.05",
           "cycle.max_cycles=1", "verify=", "output.vtk=false"]


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1100,1600",
                 "--hide-scrollbars"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options, service=Service(DRIVER))


def pictures(chrome, page, folder, stem):
    """Writes pictures of a page: light, dark, 390 px wide, and as PDF."""
    os.makedirs(folder, exist_ok=True)
    for name, width, scheme in (("light", 1000, "light"), ("dark", 1000, "dark"),
                                ("phone", 390, "light")):
        chrome.execute_cdp_cmd("Emulation.setEmulatedMedia",
                               {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        chrome.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": width, "height": 1000, "deviceScaleFactor": 1,
                                "mobile": width < 500})
        open_page(chrome, page)
        shot = chrome.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True})
        with open("%s/%s_%s.png" % (folder, stem, name), "wb") as file:
            file.write(base64.b64decode(shot["data"]))
    pdf = chrome.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})
    with open("%s/%s.pdf" % (folder, stem), "wb") as file:
        file.write(base64.b64decode(pdf["data"]))
    chrome.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def open_page(chrome, page):
    chrome.get("file://" + page)
    for _ in range(200):
        if chrome.execute_script("return document.documentElement.dataset.ready") == "true":
            return
        time.sleep(0.05)
    raise RuntimeError(page + " is not ready: " + str(chrome.get_log("browser")))


class RunPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        folder = cls.scratch.name + "/four_bar"
        command = [PROGRAM, "run", "four_bar", "-o", folder, "--quiet"]
        for change in CHANGES:
            command += ["--set", change]
        subprocess.run(command, capture_output=True, check=False)
        cls.page = folder + "/report.html"
        cls.chrome = browser()
        cls.chrome.set_window_size(1100, 1600)
        open_page(cls.chrome, cls.page)
        if PICTURES:
            pictures(cls.chrome, cls.page, PICTURES, "four_bar")
            open_page(cls.chrome, cls.page)

    @classmethod
    def tearDownClass(cls):
        cls.chrome.quit()
        cls.scratch.cleanup()

    def script(self, text, *arguments):
        return self.chrome.execute_script("return " + text, *arguments)

    def pixels(self, place):
        """The picture of the canvas in a part of the page, as a text."""
        return self.script("document.querySelector('%s canvas').toDataURL()" % place)

    def set_range(self, place, label, value):
        slider = self.chrome.find_element(By.CSS_SELECTOR,
                                          "%s input[aria-label='%s']" % (place, label))
        self.chrome.execute_script(
            "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'))",
            slider, value)

    def test_nothing_is_requested_and_no_error_is_logged(self):
        chrome = browser()
        try:
            open_page(chrome, self.page)
            requested = [e["message"] for e in chrome.get_log("performance")
                         if '"Network.requestWillBeSent"' in e["message"]]
            other = [m for m in requested if "/report.html" not in m and '"url":"data:' not in m]
            self.assertEqual(other, [])
            errors = [e for e in chrome.get_log("browser") if e["level"] == "SEVERE"]
            self.assertEqual(errors, [])
        finally:
            chrome.quit()

    def test_opening_takes_less_than_a_second(self):
        open_page(self.chrome, self.page)
        self.assertTrue(self.script("document.documentElement.dataset.ready === 'true'"))

    def test_the_time_slider_moves_the_mechanism_and_the_cursor_of_the_plots(self):
        self.set_range("#motion-view", "time", 0)
        first = self.pixels("#motion-view")
        self.set_range("#motion-view", "time", 1000)
        self.assertNotEqual(self.pixels("#motion-view"), first)
        self.assertAlmostEqual(self.script("page.time"), 0.2, places=9)
        cursors = self.script("page.graphs.map((g) => g.cursor).filter((c) => c !== undefined)")
        self.assertGreater(len(cursors), 2)
        self.assertEqual(set(cursors), {self.script("page.time")})

    def test_deformations_are_scaled(self):
        self.set_range("#motion-view", "time", 700)
        true = self.pixels("#motion-view")
        self.set_range("#motion-view", "factor of the deformations", 80)
        self.assertNotEqual(self.pixels("#motion-view"), true)
        self.set_range("#motion-view", "factor of the deformations", 0)
        self.assertEqual(self.pixels("#motion-view"), true)

    def test_uniform_material_is_drawn_beside_the_design(self):
        alone = self.pixels("#motion-view")
        boxes = self.chrome.find_elements(By.CSS_SELECTOR, "#motion-view input[type=checkbox]")
        boxes[-1].click()
        self.assertNotEqual(self.pixels("#motion-view"), alone)
        boxes[-1].click()

    def test_the_animation_plays_and_pauses(self):
        self.set_range("#motion-view", "time", 0)
        button = self.chrome.find_element(By.CSS_SELECTOR, "#motion-view button")
        button.click()
        time.sleep(0.5)
        self.assertGreater(self.script("page.time"), 0)
        button.click()
        now = self.script("page.time")
        time.sleep(0.2)
        self.assertEqual(self.script("page.time"), now)

    def test_the_slider_shows_every_iteration(self):
        count = self.script("page.iterationsViews[0].components.length")
        self.assertEqual(count, 12)
        self.set_range("#iterations-view", "iteration", 0)
        first = self.pixels("#iterations-view")
        self.assertIn("iteration 1 of 12", self.script(
            "document.querySelector('#iterations-view output').textContent"))
        self.set_range("#iterations-view", "iteration", count - 1)
        self.assertNotEqual(self.pixels("#iterations-view"), first)

    def test_plots_zoom_and_come_back(self):
        graph = self.chrome.find_element(By.CSS_SELECTOR, "#plots .graph canvas:last-of-type")
        index = self.script("page.graphs.findIndex((g) => g.maindiv_.closest('#plots'))")
        whole = self.script("page.graphs[%d].xAxisRange()" % index)
        self.chrome.execute_script("arguments[0].scrollIntoView({block: 'center'})", graph)
        actions = ActionChains(self.chrome)
        actions.move_to_element(graph).move_by_offset(-100, 0).click_and_hold()
        actions.move_by_offset(200, 3).release().perform()
        time.sleep(0.3)
        zoomed = self.script("page.graphs[%d].xAxisRange()" % index)
        self.assertLess(zoomed[1] - zoomed[0], 0.7 * (whole[1] - whole[0]))
        ActionChains(self.chrome).move_to_element(graph).double_click().perform()
        time.sleep(0.3)
        self.assertEqual(self.script("page.graphs[%d].xAxisRange()" % index), whole)

    def test_hovering_a_plot_moves_the_mechanism(self):
        self.script("page.setTime(0, 'test')")
        graph = self.chrome.find_element(By.CSS_SELECTOR, "#plots .graph canvas:last-of-type")
        self.chrome.execute_script("arguments[0].scrollIntoView({block: 'center'})", graph)
        ActionChains(self.chrome).move_to_element(graph).move_by_offset(40, 0).perform()
        self.assertGreater(self.script("page.motionView.frame"), 0)

    def test_tables_are_sorted_up_and_down(self):
        values = "[...document.querySelectorAll('#loads tbody tr')].map((r) => Number(r.cells[2].textContent))"
        head = self.chrome.find_elements(By.CSS_SELECTOR, "#loads th")[2]
        self.chrome.execute_script("arguments[0].scrollIntoView({block: 'center'})", head)
        head.click()
        up = self.script(values)
        self.assertGreater(len(up), 2)
        self.assertEqual(up, sorted(up))
        head.click()
        self.assertEqual(self.script(values), sorted(up, reverse=True))

    def test_a_load_shows_its_time(self):
        button = self.chrome.find_elements(By.CSS_SELECTOR, "#loads button[data-time]")[-1]
        self.chrome.execute_script("arguments[0].click()", button)
        self.assertAlmostEqual(self.script("page.time"),
                               float(button.get_attribute("data-time")), places=9)

    def test_a_load_draws_its_deformed_design(self):
        buttons = "document.querySelectorAll('button[data-deformed]')"
        n = self.script(buttons + ".length")
        self.assertGreater(n, 1)
        self.chrome.execute_script(buttons + "[1].click()")
        self.assertEqual(self.script(buttons + ".length"), n - 1)
        drawn = self.script("""(() => {
            const canvas = document.querySelector('.deformed canvas');
            const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            return pixels.data.filter((v, k) => k % 4 === 3 && v > 0).length /
                (canvas.width * canvas.height); })()""")
        self.assertGreater(drawn, 0.02)
        self.assertLess(drawn, 0.9)

    def test_nothing_is_wider_than_a_phone(self):
        self.chrome.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": 390, "height": 800, "deviceScaleFactor": 2,
                                     "mobile": True})
        open_page(self.chrome, self.page)
        self.assertLessEqual(self.script("document.documentElement.scrollWidth"), 390)
        self.chrome.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        open_page(self.chrome, self.page)

    def test_no_text_is_smaller_than_11_pixels(self):
        small = self.script("""[...document.querySelectorAll('body *')].filter((e) =>
            [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()) &&
            !['SCRIPT', 'STYLE', 'OPTION'].includes(e.tagName) && e.getClientRects().length &&
            parseFloat(getComputedStyle(e).fontSize) < 11).map((e) => e.outerHTML.slice(0, 80))""")
        self.assertEqual(small, [])


if __name__ == "__main__":
    unittest.main()
