"""A headless Chromium over WebDriver, with Python's standard library only."""
import base64
import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


# Most checks need no more, and a browser without a graphics card draws it in half the time of 1400 x 1000.
WINDOW = (1000, 700)


def driver_path():
    return shutil.which("chromedriver")


def run_checks(checks, wanted, make, without_webgl):
    """Runs functions of a browser and the pages that make(folder) returns, then without_webgl(pages); all, or those whose names are
    `wanted`. Prints a line each and returns the exit code: 1 where one failed, 77 where there is no chromedriver."""
    if not driver_path():
        print("skipped: no chromedriver (Debian: apt-get install chromium-driver)")
        return 77
    failed = 0

    def run(function, *arguments):
        if wanted and function.__name__ not in wanted:
            return 0
        start = time.monotonic()
        try:
            function(*arguments)
            print(f"ok      {function.__name__} ({time.monotonic() - start:.1f} s)", flush=True)
        except Exception as error:  # whatever it is, the other checks go on
            print(f"FAILED  {function.__name__}: {type(error).__name__}: {error}", flush=True)
            return 1
        return 0

    with tempfile.TemporaryDirectory(prefix="dea_page_") as folder:
        pages = make(folder)
        # The first check sees the maps as users do. Software takes twice as long for smooth edges: the others go without.
        for smooth, some in ((True, checks[:1]), (False, checks[1:])):
            if wanted and not any(function.__name__ in wanted for function in some):
                continue
            with Browser(smooth=smooth) as b:
                b.size(*WINDOW)
                failed += sum(run(function, b, pages) for function in some)
        failed += run(without_webgl, pages)
    return 1 if failed else 0


class Browser:
    """with Browser() as b: b.open("file:///..."); ends its own processes. smooth: maps' edges are smoothed, as for users."""

    def __init__(self, width=1400, height=1000, dark=False, webgl=True, smooth=True):
        self.folder = tempfile.mkdtemp(prefix="dea_browser_")
        self.downloads = os.path.join(self.folder, "downloads")
        os.mkdir(self.downloads)
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.port = s.getsockname()[1]
        # 127.0.0.1 is this machine: no proxy
        self.opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        self.driver = subprocess.Popen([driver_path(), f"--port={self.port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        self.session = None
        arguments = ["--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run",
                     "--disable-background-networking", "--disable-component-update", "--disable-sync",
                     "--disable-default-apps", "--disable-extensions", "--disable-dev-shm-usage",
                     f"--user-data-dir={self.folder}/profile", f"--window-size={width},{height}",
                     "--force-device-scale-factor=1"]
        # WebGL by software; all else is drawn without it, in two thirds of the time
        arguments += (["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization",
                       "--disable-accelerated-2d-canvas", "--disable-gpu-compositing"] if webgl
                      else ["--disable-gpu", "--disable-3d-apis"])
        if dark:
            arguments.append("--force-dark-mode")
        capabilities = {"alwaysMatch": {
            "browserName": "chrome", "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
            "goog:chromeOptions": {"args": arguments, "prefs": {"download.default_directory": self.downloads}}}}
        try:
            for _ in range(200):
                try:
                    self.request("GET", "/status")
                    break
                except OSError:
                    time.sleep(0.05)
            self.session = self.request("POST", "/session", {"capabilities": capabilities})["sessionId"]
            self.cdp("Browser.setDownloadBehavior", behavior="allow", downloadPath=self.downloads)
            if not smooth:
                self.cdp("Page.addScriptToEvaluateOnNewDocument", source="""
                    const context = HTMLCanvasElement.prototype.getContext;
                    HTMLCanvasElement.prototype.getContext = function (kind, options) {
                      return context.call(this, kind, kind === "webgl2" ? { ...options, antialias: false } : options);
                    };""")
        except BaseException:
            self.close()
            raise

    def request(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data, method=method,
                                         headers={"Content-Type": "application/json"})
        try:
            with self.opener.open(request, timeout=180) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(f"{method} {path}: {error.read().decode(errors='replace')[:600]}") from None

    def call(self, method, path, body=None):
        return self.request(method, f"/session/{self.session}{path}", body)

    def open(self, url):
        self.call("POST", "/url", {"url": url})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, script, seconds=60, what=None):
        """Until the expression is true; its value."""
        end = time.monotonic() + seconds
        while True:
            value = self.run("return " + script)
            if value:
                return value
            if time.monotonic() > end:
                raise AssertionError(f"waited {seconds} s for: {what or script}")
            time.sleep(0.05)

    def cdp(self, command, **parameters):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def log(self, kind):
        return self.call("POST", "/se/log", {"type": kind})

    def size(self, width, height):
        """Of the page, also narrower than a window may be."""
        self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        # until the page has followed
        self.run("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def scheme(self, name):
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def pointer(self, *steps):
        """Mouse actions in page coordinates: ("move", x, y), ("down",), ("up",)."""
        actions = []
        for step in steps:
            if step[0] == "move":
                actions.append({"type": "pointerMove", "duration": 0, "x": round(step[1]), "y": round(step[2])})
            else:
                actions.append({"type": "pointerDown" if step[0] == "down" else "pointerUp", "button": 0})
        self.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse",
                                                     "parameters": {"pointerType": "mouse"}, "actions": actions}]})

    def key(self, key):
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": [
            {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]}]})

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).click()", selector)

    def screenshot(self, path, whole=True):
        image = self.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=whole,
                         **({"clip": {"x": 0, "y": 0, "scale": 1, **self.run(
                             "return {width: document.documentElement.clientWidth, "
                             "height: document.documentElement.scrollHeight}")}} if whole else {}))
        with open(path, "wb") as file:
            file.write(base64.b64decode(image["data"]))

    def downloaded(self, seconds=30):
        """The next file that is saved: (name, bytes); it is taken away."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            names = [n for n in os.listdir(self.downloads) if not n.endswith((".crdownload", ".tmp"))
                     and not n.startswith(".")]
            if names:
                path = os.path.join(self.downloads, names[0])
                time.sleep(0.2)
                with open(path, "rb") as file:
                    content = file.read()
                if content:
                    os.remove(path)
                    return names[0], content
            time.sleep(0.05)
        raise AssertionError(f"no file was saved in {seconds} s")

    def close(self):
        if self.session:
            try:
                self.request("DELETE", f"/session/{self.session}")
            except (OSError, RuntimeError):
                pass
            self.session = None
        if self.driver:
            self.driver.terminate()
            try:
                self.driver.wait(10)
            except subprocess.TimeoutExpired:
                self.driver.kill()
                self.driver.wait()
            self.driver = None
        shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
