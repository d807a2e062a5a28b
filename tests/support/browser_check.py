#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens pages in headless Chromium and says what is wrong with them: browser_check.py URL...

Wrong is: an error on the console or an exception, a request to another origin, something wider than the window at any of
the widths, also as it is printed, and a page that cannot be printed. Exit code 0: nothing; 1: a line for each fault; 77:
there is no Chromium that runs here, with the reason.
"""
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
from urllib.parse import urlsplit

WIDTHS = (360, 600, 800, 1024, 1366, 1920)
# A4 less the margins of the style, in pixels of 1/96 inch.
PRINTED = 688
# What is wider than the window and is not inside something that scrolls by itself.
WIDER = """(() => {
  const wide = document.documentElement.clientWidth + 1, found = [];
  if (document.documentElement.scrollWidth > wide) found.push('the page: ' + document.documentElement.scrollWidth);
  for (const e of document.body.querySelectorAll('*')) {
    let scrolls = false;
    for (let p = e.parentElement; p; p = p.parentElement)
      scrolls = scrolls || ['auto', 'scroll', 'hidden'].includes(getComputedStyle(p).overflowX) || p.tagName === 'svg';
    if (!scrolls && e.getBoundingClientRect().right > wide) found.push(e.tagName + ' ' + e.className + ': ' +
      e.getBoundingClientRect().right.toFixed(0));
  }
  return JSON.stringify(found.slice(0, 3));
})()"""


class Chromium:
    """A browser behind its pipe of messages: JSON, each ended by a zero byte."""

    def __init__(self, program, folder):
        to_browser, our_out = os.pipe()
        our_in, from_browser = os.pipe()

        def descriptors():
            # Through numbers that neither end has, so that no copy overwrites the other.
            os.dup2(to_browser, 100)
            os.dup2(from_browser, 101)
            os.dup2(100, 3)
            os.dup2(101, 4)

        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-background-networking", "--user-data-dir=" + folder, "--remote-debugging-pipe"],
            preexec_fn=descriptors, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.out = our_out
        self.input = os.fdopen(our_in, "rb", buffering=0)
        self.received = b""
        self.events = []
        self.number = 0
        self.session = None

    def message(self):
        while b"\0" not in self.received:
            some = self.input.read(65536)
            if not some:
                raise RuntimeError("the browser ended")
            self.received += some
        text, self.received = self.received.split(b"\0", 1)
        return json.loads(text)

    def ask(self, method, **parameters):
        self.number += 1
        call = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            call["sessionId"] = self.session
        os.write(self.out, json.dumps(call).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") != self.number:
                self.events.append(answer)
                continue
            if "error" in answer:
                raise RuntimeError(method + ": " + answer["error"]["message"])
            return answer["result"]

    def wait_for(self, method):
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.message())

    def open_tab(self):
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(domain + ".enable")

    def wider(self):
        return json.loads(self.ask("Runtime.evaluate", expression=WIDER)["result"]["value"])


def said_wrong(events, url):
    origin = urlsplit(url)
    for event in events:
        method, data = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            yield "exception: " + json.dumps(data["exceptionDetails"].get("text", ""))
        if method == "Runtime.consoleAPICalled" and data["type"] in ("error", "assert"):
            yield "console: " + json.dumps(data["args"])[:200]
        if method == "Log.entryAdded" and data["entry"]["level"] == "error":
            yield "log: " + data["entry"]["text"] + " " + data["entry"].get("url", "")
        if method == "Network.requestWillBeSent":
            asked = urlsplit(data["request"]["url"])
            if asked.scheme != "data" and (asked.scheme, asked.netloc) != (origin.scheme, origin.netloc):
                yield "asks elsewhere: " + data["request"]["url"][:100]


def faults_of(browser, url):
    browser.events.clear()
    browser.ask("Emulation.setEmulatedMedia", media="screen")
    browser.ask("Page.navigate", url=url)
    browser.wait_for("Page.loadEventFired")
    # What a script asks for after it was loaded: two frames and the answers to what is on its way.
    browser.ask("Runtime.evaluate", awaitPromise=True, expression="new Promise(r => setTimeout(r, 1500))")
    for width in WIDTHS:
        browser.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        for part in browser.wider():
            yield f"wider than {width} pixels: {part}"
    browser.ask("Emulation.setDeviceMetricsOverride", width=PRINTED, height=972, deviceScaleFactor=1, mobile=False)
    browser.ask("Emulation.setEmulatedMedia", media="print")
    for part in browser.wider():
        yield "wider than the paper: " + part
    pdf = base64.b64decode(browser.ask("Page.printToPDF", preferCSSPageSize=True)["data"])
    if not pdf.startswith(b"%PDF") or len(pdf) < 2000:
        yield "cannot be printed"
    yield from said_wrong(browser.events, url)


def main():
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if not program:
        print("chromium is not installed")
        return 77
    bad = False
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        try:
            browser = Chromium(program, folder)
            browser.open_tab()
        except (OSError, RuntimeError) as why:
            print("chromium does not run here:", why)
            return 77
        try:
            for url in sys.argv[1:]:
                for fault in faults_of(browser, url):
                    print(url.rsplit("/", 1)[-1] or url, fault)
                    bad = True
        finally:
            browser.process.kill()
            browser.process.wait()
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
