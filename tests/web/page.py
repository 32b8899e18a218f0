"""page.py PAGE.html DIGESTS_FOLDER DIGESTS.txt PROGRAM STILLS SHOTS: the page in Debian's Chromium, opened from a
folder, by keyboard and pointer; its figures against those of the program. Pictures of it go to SHOTS."""
import base64
import io
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tarfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PAGE, DIGESTS, EXPECTED, PROGRAM, STILLS, SHOTS = [pathlib.Path(a).resolve() for a in sys.argv[1:7]]
FPS, SIZE = 20, (320, 240)
failures = []


def check(truth, sentence):
    if not truth:
        failures.append(sentence)
        print("FAILED:", sentence, flush=True)


def clip(path):
    """Two seconds: dark, then 4 times the codes, with a texture."""
    random.seed(1)
    width, height = SIZE
    texture = bytes(random.randrange(10, 50) for _ in range(width * height))
    with open(path, "wb") as f:
        f.write(b"YUV4MPEG2 W%d H%d F%d:1 Ip A1:1 C420mpeg2\n" % (width, height, FPS))
        for n in range(2 * FPS):
            bright = n >= FPS
            luma = bytes(16 + v * (4 if bright else 1) for v in texture)
            f.write(b"FRAME\n" + luma + bytes([118]) * (width * height // 4) + bytes([140]) * (width * height // 4))


def chromium(*arguments):
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for a in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--use-fake-ui-for-media-stream",
              "--use-fake-device-for-media-stream", "--window-size=1280,1000", *arguments):
        options.add_argument(a)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    browser.set_script_timeout(120)
    browser.get(PAGE.as_uri())
    wait(browser, "return window.pupil && pupil.count > 3")
    return browser


def wait(browser, condition, seconds=30, *arguments):
    end = time.time() + seconds
    while time.time() < end:
        value = browser.execute_script(condition, *arguments)
        if value:
            return value
        time.sleep(0.05)
    check(False, f"never came: {condition}")
    return None


def digests(browser):
    """The digest program, at both levels, in this browser."""
    expected = EXPECTED.read_text()
    for name in ("digest", "digest_scalar"):
        module = base64.b64encode((DIGESTS / name).read_bytes()).decode()
        text = browser.execute_async_script("""
            const [module, done] = arguments, lines = [];
            let memory;
            const print = (at) => {
                const all = new Uint8Array(memory.buffer);
                lines.push(new TextDecoder().decode(all.slice(at, all.indexOf(0, at))));
            };
            WebAssembly.instantiate(bytesOfBase64(module), { board: { print } }).then(({ instance }) => {
                memory = instance.exports.memory;
                instance.exports.start();
                done(lines.join(""));
            }).catch((e) => done(String(e)));""", module)
        wrong = sum(a != b for a, b in zip(text.splitlines(), expected.splitlines()))
        check(text == expected, f"Chromium: {name} has other bits, {wrong} lines: {text[:80]}")
        print(f"Chromium, {name}: {len(text.splitlines())} digests, {wrong} others")


def replay(*arguments):
    command = [PROGRAM, "replay", *map(str, arguments), "--stats", "-", "-q"]
    out = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    return [json.loads(line) for line in out.stdout.splitlines()]


def open_file(browser, path):
    browser.execute_script("document.getElementById('file').hidden = false")
    browser.find_element(By.ID, "file").send_keys(str(path))
    browser.execute_script("document.getElementById('file').hidden = true")


def stills(browser):
    """Each format: the level of the program's first frame."""
    browser.execute_script("document.getElementById('steps').checked = false")
    names = sorted(p for p in STILLS.iterdir() if p.suffix in (".pfm", ".hdr", ".exr", ".png"))
    for path in names:
        open_file(browser, path)
        wait(browser, "return document.getElementById('source-name').textContent.startsWith(arguments[0]) && "
             "pupil.count > 0", 20, path.name)
        got = browser.execute_script("return ['metered_ev', 'adapted_ev'].map((n) => pupil.core.result(0, n))")
        line = replay(path, "-n", 1)[0]
        check(got == [line["metered_ev"], line["adapted_ev"]], f"{path.name}: the page has {got}, the program "
              f"{line['metered_ev']}, {line['adapted_ev']}")
    check(len(names) >= 11, f"only {len(names)} stills")
    print(f"{len(names)} stills: the program's levels")


def damaged(browser, room):
    for name, cut in (("still.pfm", 500), ("still.hdr", 300), ("zip16.exr", 900), ("rgb48.png", 700)):
        broken = room / f"broken-{name}"
        broken.write_bytes((STILLS / name).read_bytes()[:cut])
        open_file(browser, broken)
        text = wait(browser, "const m = document.getElementById('message'); return !m.hidden && "
                    "m.textContent.includes(arguments[0]) && m.textContent", 10, broken.name)
        print(f"damaged: {text}")
    (room / "letter.txt").write_text("not a picture")
    open_file(browser, room / "letter.txt")
    wait(browser, "return document.getElementById('message').textContent.startsWith('letter.txt: is none of')", 10)
    check(browser.execute_script("return pupil.still !== null"), "a damaged file has taken the picture away")


# From here on counts saved files and live cameras.
WATCH = """
    window.saved = [];
    HTMLAnchorElement.prototype.click = function () { saved.push([this.download, this.href]); };
    window.tracks = [];
    const ask = navigator.mediaDevices.getUserMedia.bind(navigator.mediaDevices);
    navigator.mediaDevices.getUserMedia = async (wanted) => {
        const stream = await ask(wanted);
        tracks.push(...stream.getTracks());
        return stream;
    };
    window.press = (...names) => names.forEach((name) => document.getElementById(name).click());
"""


def state(browser):
    return browser.execute_script("""
        const text = (id) => document.getElementById(id).textContent;
        return { saved: saved.length, recorded: text("recorded"), name: text("source-name"), count: pupil.count,
            message: document.getElementById("message").hidden ? "" : text("message"),
            still: !!pupil.still, live: tracks.filter((t) => t.readyState === "live").length };""")


def recordings(browser, room):
    """Another source, the limit of bytes and a second press end a recording; what there is is saved."""
    browser.execute_script("press('use-scene', 'record')")
    wait(browser, "return pupil.recording.lines.length > 3")
    browser.execute_script("press('use-scene')")
    now = state(browser)
    check(now["saved"] == 1 and now["recorded"].startswith("Another source was chosen: "),
          f"recorded, then another source: {now}")
    browser.execute_script("press('record', 'record')")
    now = state(browser)
    check(now["saved"] == 1 and now["recorded"] == "No frame came: nothing is saved", f"pressed twice: {now}")
    browser.execute_script("press('use-scene', 'record')")
    open_file(browser, STILLS / "still.pfm")
    wait(browser, "return saved.length > 1", 10)
    (room / "large.pfm").write_bytes(b"Pf\n4000 3000\n-1.0\n" + struct.pack("<f", 0.5) * (4000 * 3000))
    open_file(browser, room / "large.pfm")
    wait(browser, "return document.getElementById('source-name').textContent.startsWith('large.pfm')")
    browser.execute_script("press('record')")
    wait(browser, "return saved.length > 2", 60)
    now = state(browser)
    check(now["recorded"].startswith("The limit of 256 MiB is reached: 1 frame in "), f"the limit of bytes: {now}")
    browser.execute_script("press('use-scene')")
    print(f"recordings: saved when the source changes; {now['recorded'].split(':')[0]}")


def sources(browser):
    """The source that was asked for last is shown, and no other camera stays on."""
    for names, live in ((("use-camera", "use-camera"), 1), (("use-scene",), 0), (("use-camera", "use-scene") * 4, 0),
                        (("use-scene", "use-camera") * 4, 1)):
        browser.execute_script("press(...arguments)", *names)
        time.sleep(1.5)
        now = state(browser)
        check(now["live"] == live and now["still"] == (live == 0) and now["message"] == "", f"pressed {names}: {now}")
    browser.execute_script("press('use-scene')")
    print("sources: the last one that was asked for")


def refused(browser, room):
    """A video that cannot be played and a picture that is too large: a sentence, and the shown picture stays."""
    ffmpeg = ["ffmpeg", "-loglevel", "error", "-y", "-f", "lavfi", "-i"]
    subprocess.run([*ffmpeg, "testsrc=s=320x240:d=1", "-c:v", "libvpx", room / "whole.webm"], check=True)
    large = ["color=gray:s=9000x7500", "-frames:v", "1", "-pix_fmt", "gray", room / "large.jpg"]
    subprocess.run([*ffmpeg, *large], check=True)
    (room / "junk.mp4").write_bytes(random.Random(2).randbytes(5000))
    (room / "nl.pfm").write_bytes(b"PF\n" + b"9" * 600 + b" 4\n-1.0\n")
    (room / "empty.webm").write_bytes(b"")
    (room / "cut.webm").write_bytes((room / "whole.webm").read_bytes()[:3000])
    for name, words in (("nl.pfm", "width begins with 999"), ("junk.mp4", "cannot play it"), ("empty.webm", "is empty"),
                        ("cut.webm", "cannot play it"), ("large.jpg", "9000 x 7500 pixels; at most")):
        browser.execute_script("press('use-scene')")
        before = state(browser)
        open_file(browser, room / name)
        wait(browser, "const m = document.getElementById('message'); return !m.hidden && "
             "m.textContent.startsWith(arguments[0])", 15, name)
        count = state(browser)["count"]
        time.sleep(0.3)
        now = state(browser)
        check(words in now["message"], f"{name}: {now['message']}")
        check(now["still"] and now["name"] == before["name"] and now["count"] > count,
              f"{name}: what was shown does not stay: {now}")
        print(f"refused: {now['message']}")
    browser.execute_script("press('use-scene')")
    subprocess.run([*ffmpeg, "testsrc=s=320x240", "-frames:v", "1", "-c:v", "libvpx", room / "one.webm"], check=True)
    for name, count in (("one.webm", 0), ("whole.webm", 3)):
        open_file(browser, room / name)
        wait(browser, "return pupil.frames && pupil.count > arguments[0]", 10, count)
    check(state(browser)["message"] == "", f"whole.webm: {state(browser)}")
    browser.execute_script("press('use-scene')")


def camera(browser, room):
    """The camera's frames through the page, recorded; the program replays the recording: the same levels, all bits."""
    browser.find_element(By.ID, "use-camera").click()
    wait(browser, "return pupil.frames && pupil.count > 5")
    browser.execute_script("pupil.log = []; document.getElementById('record').click(); pupil.log.length = 0")
    wait(browser, "return pupil.recording.lines.length >= 70")
    data = browser.execute_async_script("""
        const done = arguments[0], recording = pupil.recording;
        const count = recording.lines.length, log = pupil.log.slice(0, count);
        recording.tar().arrayBuffer().then((buffer) => {
            let text = "";
            const bytes = new Uint8Array(buffer);
            for (let i = 0; i < bytes.length; i += 30000)
                text += String.fromCharCode(...bytes.subarray(i, i + 30000));
            done([count, log, btoa(text), pupil.core.pixel]);
        });""")
    count, log, tar, pixel = data
    check(pixel == 22, f"the camera's frames are no I420 but {pixel}")
    with tarfile.open(fileobj=io.BytesIO(base64.b64decode(tar))) as archive:
        archive.extractall(room)
    lines = replay(room / "pupil-recording")
    check(len(lines) == count, f"recorded {count} frames, replayed {len(lines)}")
    wrong = [(line["frame"], entry, line["adapted_ev"]) for line, entry in zip(lines, log)
             if entry[1:] != [line["metered_ev"], line["adapted_ev"]]]
    levels = [line["metered_ev"] for line in lines]
    check(not wrong, f"{len(wrong)} frames have other levels: {wrong[:3]}")
    check(max(levels) - min(levels) > 2, f"the light does not step: {min(levels)}..{max(levels)}")
    print(f"camera: {count} frames, light from {min(levels):.2f} to {max(levels):.2f} EV; {len(wrong)} levels differ "
          "from pupil replay's")
    browser.execute_script("pupil.stopRecording('')")


SETTLE = """
    const core = pupil.core, r = (view, name) => core.result(view, name);
    cancelAnimationFrame(pupil.ticking);
    core.calls.reset();
    let t = 0n;
    const frame = (ev, ns) => {
        core.calls.light(core.lightAt, core.frameAt, core.frameBytes / 4, 2 ** ev);
        t += BigInt(ns);
        core.take(RGB_CODING);
        core.meter();
        core.adapt(t, 0, 0);
    };
    const picture = () => { const d = core.map(0, 0).data; let sum = 0;
        for (let i = 0; i < d.length; i += 4) sum += d[i + 1];
        return sum / d.length * 4; };
"""


def drive(browser, name, value):
    """Sets a control as a hand does, and runs what it announces."""
    browser.execute_script("""
        const input = document.getElementById("set-" + arguments[0]);
        input.value = arguments[1];
        input.dispatchEvent(new Event(input.tagName === "SELECT" ? "change" : "input"));""", name, value)


def shown(browser, name):
    return browser.execute_script("return document.querySelector(`output[for]`) && document.getElementById('set-' + "
                                  "arguments[0]).getAttribute('aria-valuetext')", name)


def sliders(browser):
    """Each control does what it says, by numbers of the core."""
    browser.find_element(By.ID, "use-scene").click()
    run = lambda text: browser.execute_script(SETTLE + text)
    base = run("frame(0, 1e8); return [r(0, 'scale'), picture(), r(0, 'adapted_ev'), r(0, 'held_back_ev')]")
    drive(browser, "ev_compensation", 1)
    check(run("frame(0, 1e8); return r(0, 'scale')") == 2 * base[0], "compensation of 1 EV is no factor of 2")
    check(shown(browser, "ev_compensation") == "1.0 EV", "compensation is shown without its unit")
    drive(browser, "ev_compensation", 0)
    drive(browser, "key", 36)
    twice = run("frame(0, 1e8); return r(0, 'scale')")
    check(math.isclose(twice, 2 * base[0], rel_tol=1e-6), "twice the key is no factor of 2")
    drive(browser, "key", 18)
    for name, step in (("tau_light_s", 4), ("tau_dark_s", -4)):
        drive(browser, name, 0)
        check(abs(run(f"frame(0, 1e8); frame({step}, 1e8); return r(0, 'adapted_ev') - r(0, 'held_back_ev') - "
                      "r(0, 'metered_ev')")) < 1e-9, f"{name} 0 s is not at once")
        drive(browser, name, 14)  # 1.5 s
        check(shown(browser, name) == "1.50 s", f"{name} shows {shown(browser, name)}")
        got = run(f"frame(0, 1e8); const a = r(0, 'adapted_ev') - r(0, 'held_back_ev'); frame({step}, 1.5e9); "
                  f"return (r(0, 'adapted_ev') - r(0, 'held_back_ev') - a) / {step}")
        check(abs(got - (1 - math.exp(-1))) < 0.02, f"{name}: {got} of the way after its time, not 1 - 1/e")
    drive(browser, "frame_weight", 9)  # 0.2
    got = run("frame(0, 1e8); const a = r(3, 'adapted_ev'); frame(4, 1e8); return (r(3, 'adapted_ev') - a) / 4")
    check(abs(got - 0.2) < 0.02, f"a weight of 0.2 moves formula 3 by {got}")
    drive(browser, "ev_min", -0.5)
    check(run("frame(-4, 1e8); return r(0, 'adapted_ev')") == -0.5, "the lowest level is not kept")
    drive(browser, "ev_min", -16)
    drive(browser, "ev_max", 1)
    check(run("frame(8, 1e8); return r(0, 'adapted_ev')") == 1, "the highest level is not kept")
    drive(browser, "ev_max", 16)
    browser.execute_script("pupil.core.bytes(pupil.core.lightAt, pupil.core.frameBytes)")
    bright = ("const light = new Float32Array(core.calls.memory.buffer, core.lightAt, core.frameBytes / 4); "
              "const old = light.slice(); for (let i = 0; i < light.length / 12; i++) light[i] = 200; "
              "frame(0, 1e8); light.set(old); return r(0, 'held_back_ev')")
    held = run(bright)
    drive(browser, "highlight_ev", 0)
    check(held > 0.5 and run(bright) == 0, f"highlights hold back {held} EV")
    drive(browser, "highlight_ev", 2)
    white = run("frame(0, 1e8); return r(0, 'white_ev')")
    drive(browser, "white_quantile", 90)
    check(run("frame(0, 1e8); return r(0, 'white_ev')") < white, "less light up to white leaves the white where it was")
    drive(browser, "white_quantile", 99.5)
    eye = run("frame(0, 1e8); frame(4, 1e8); return picture() && r(5, 'scale')")
    drive(browser, "eye_unit_cd_m2", 0)
    check(run("frame(0, 1e8); frame(4, 1e8); return r(5, 'scale')") != eye, "the eye's unit does nothing")
    drive(browser, "eye_unit_cd_m2", 6)
    for name, values in (("white_mode", (1, 2)), ("curve", (1, 2, 3, 4)), ("metering", (1, 2))):
        for value in values:
            drive(browser, name, value)
            check(run("frame(0, 1e8); return picture()") != base[1], f"{name} {value} does not change the picture")
        drive(browser, name, 0)
    drive(browser, "lock", 1)
    check(run("frame(0, 1e8); const a = r(0, 'adapted_ev'); frame(4, 1e9); return r(0, 'adapted_ev') - a") == 0,
          "the level is not locked")
    drive(browser, "lock", 0)
    flicker = ("let most = 0; for (let i = 0; i < 400; i++) { frame(0.2 * Math.sin(2 * Math.PI * 100 * i / 30 + 1), "
               "33333333); most = i < 370 ? 0 : Math.max(most, Math.abs(r(0, 'flicker_ev'))); } return most")
    on = run(flicker)
    drive(browser, "flicker", 0)
    check(run(flicker) == 0, "flicker is removed, though it should stay")
    check(on > 0.05, f"only {on} EV of flicker is removed")
    browser.find_element(By.ID, "defaults").click()
    check(run("frame(0, 1e8); return [r(0, 'scale'), picture(), r(0, 'adapted_ev'), r(0, 'held_back_ev')]") == base,
          "Defaults does not bring all back")
    browser.find_element(By.ID, "use-scene").click()
    print("sliders and choices: each does what it says")


def region(browser):
    browser.execute_script("window.scrollTo(0, 0)")
    stage = browser.find_element(By.ID, "stage")
    part = lambda: browser.execute_script("return pupil.picture.region")
    drag = ActionChains(browser).move_to_element_with_offset(stage, -200, -100).click_and_hold()
    drag.move_by_offset(150, 80).release().perform()
    r, size = part(), stage.size
    check(r and abs(r["width"] - 150 / size["width"]) < 0.01 and abs(r["height"] - 80 / size["height"]) < 0.01,
          f"dragged: {r}")
    inside = browser.execute_script("return pupil.core.result(0, 'metered_ev')")
    time.sleep(0.3)
    now = browser.execute_script("return pupil.core.result(0, 'metered_ev')")
    browser.save_screenshot(str(SHOTS / "region.png"))
    ActionChains(browser).move_to_element_with_offset(stage, 100, 100).click().perform()
    time.sleep(0.3)
    whole = browser.execute_script("return pupil.core.result(0, 'metered_ev')")
    check(part() is None and now != whole, f"metering by dragging: {inside}, {now}, whole {whole}")
    print(f"metering by dragging: {now:.2f} EV there, {whole:.2f} EV in all")


def keyboard(browser):
    """All controls in turn by Tab alone; the region, the line and a slider by keys."""
    browser.get(PAGE.as_uri())
    wait(browser, "return window.pupil && pupil.count > 3")
    wanted = set(browser.execute_script("""
        const all = [...document.querySelectorAll("button, select, input, [tabindex]")];
        return all.filter((e) => e.offsetParent !== null && !e.disabled).map((e) => e.id);"""))
    seen, press = set(), lambda *keys: ActionChains(browser).send_keys(*keys).perform()
    for _ in range(len(wanted) + 6):
        press(Keys.TAB)
        name, outline = browser.execute_script("const e = document.activeElement; "
                                               "return [e.id, getComputedStyle(e).outlineStyle]")
        seen.add(name)
        check(not name or outline != "none", f"{name}: where the keyboard is cannot be seen")
        if name == "stage":
            press(Keys.ENTER)
            first = browser.execute_script("return pupil.picture.region")
            press(Keys.ARROW_LEFT, Keys.ARROW_UP)
            ActionChains(browser).key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT).key_up(Keys.SHIFT).perform()
            then = browser.execute_script("return pupil.picture.region")
            check(first and then["x"] < first["x"] and then["y"] < first["y"] and then["width"] > first["width"],
                  "the region by keys")
            press(Keys.ESCAPE)
            check(browser.execute_script("return pupil.picture.region") is None, "Escape leaves the region")
        elif name == "split":
            press(Keys.END)
            check(browser.execute_script("return pupil.picture.split") == 1, "the line by keys")
            press(Keys.HOME)
        elif name == "set-key":
            press(Keys.ARROW_RIGHT)
            check(browser.execute_script("return pupil.core.settings.key") == 0.19, "a slider by keys")
        elif name == "laws-on":
            press(Keys.SPACE)
    check(wanted <= seen, f"not reached by Tab: {sorted(wanted - seen)}")
    check(browser.execute_script("return !document.getElementById('laws').hidden"), "the laws by keys")
    print(f"keyboard: {len(wanted)} controls reached")


CONTRAST = """
    const linear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
    const light = (c) => { const v = c.map((x) => linear(x / 255));
        return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; };
    const rgba = (text) => { const n = text.match(/[\\d.]+/g).map(Number); return [n.slice(0, 3), n[3] ?? 1]; };
    const behind = (e) => { for (; e; e = e.parentElement) { const [c, a] = rgba(getComputedStyle(e).backgroundColor);
        if (a > 0) return c; } return [255, 255, 255]; };
    const low = [];
    let least = 99;
    for (const e of document.querySelectorAll("body *")) {
        const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
        if (!own || e.offsetParent === null || ["SCRIPT", "OPTION"].includes(e.tagName)) continue;
        const l = [light(rgba(getComputedStyle(e).color)[0]), light(behind(e))].sort((a, b) => b - a);
        const ratio = (l[0] + 0.05) / (l[1] + 0.05);
        least = Math.min(least, ratio);
        if (ratio < 4.5) low.push(`${e.tagName} "${e.textContent.slice(0, 30)}" ${ratio.toFixed(2)}`);
    }
    return [low, least];
"""


def contrast(browser):
    """WCAG 2.1, 1.4.3: 4.5 for text, in both colour schemes."""
    for scheme in ("light", "dark"):
        wanted = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", wanted)
        low, least = browser.execute_script(CONTRAST)
        check(not low, f"{scheme}: too little contrast: {low[:4]}")
        print(f"contrast, {scheme}: at least {least:.1f}")
    browser.save_screenshot(str(SHOTS / "dark.png"))
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def shots(browser):
    browser.get(PAGE.as_uri())
    wait(browser, "return window.pupil && pupil.count > 3")
    browser.find_element(By.ID, "laws-on").click()
    for name, width in (("wide", 1280), ("phone", 390)):
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})
        time.sleep(1)
        # not window.innerWidth: a phone's grows with the page
        over = browser.execute_script("return [...document.querySelectorAll('body *')]"
                                      ".filter(e => e.getBoundingClientRect().right > arguments[0])"
                                      ".map(e => e.id || e.className)", width)
        check(not over, f"{name}: beyond the window's right edge: {over}")
        height = browser.execute_script("return document.documentElement.scrollHeight")
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
        time.sleep(5)
        browser.save_screenshot(str(SHOTS / f"{name}.png"))
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def steering(browser):
    """Chromium's own fake camera has an exposure time from 1 to 10 ms."""
    browser.find_element(By.ID, "use-camera").click()
    wait(browser, "return pupil.frames && pupil.count > 5")
    before = browser.execute_script("return pupil.exposure.now.exposureS")
    browser.find_element(By.ID, "loop").click()
    wait(browser, "return pupil.exposure.writes > 1 && pupil.exposure.now.exposureS !== arguments[0]", 20, before)
    time.sleep(1)
    asked, has = browser.execute_script("return [pupil.core.calls.sensor_result(0), pupil.exposure.now.exposureS]")
    text = browser.find_element(By.ID, "loop-state").text
    check(abs(has - asked) <= 0.5e-3 and has != before, f"asked {asked} s, the camera has {has} s, before {before} s")
    browser.find_element(By.ID, "loop").click()
    # The fake camera stays manual, regardless of commands.
    wait(browser, "return pupil.exposure.track.getConstraints().advanced?.[0].exposureMode === 'continuous'", 10)
    print(f"the camera's exposure: from {before * 1e3:g} to {has * 1e3:g} ms ({text}), then given back")


def quiet(browser, what):
    """Nothing is loaded, and no error is hidden."""
    loaded = browser.execute_script("return performance.getEntriesByType('resource').map((e) => e.name)")
    check([n for n in loaded if not n.startswith(("blob:", "data:"))] == [], f"{what}: loads {loaded[:3]}")
    severe = [e["message"] for e in browser.get_log("browser") if e["level"] == "SEVERE"]
    check(not severe, f"{what}: {severe[:3]}")


def main():
    room = SHOTS / "room"
    room.mkdir(parents=True, exist_ok=True)
    clip(room / "steps.y4m")
    browser = chromium(f"--use-file-for-fake-video-capture={room / 'steps.y4m'}")
    try:
        digests(browser)
        stills(browser)
        damaged(browser, room)
        sliders(browser)
        region(browser)
        browser.execute_script(WATCH)
        recordings(browser, room)
        sources(browser)
        refused(browser, room)
        camera(browser, room)
        measured = browser.execute_async_script("""
            const done = arguments[0];
            pupil.showStill(testScene(), "Test scene");
            pupil.measure().then(() => done(pupil.measured));""")
        print("ns a pixel, 480x270 RGB32F:", ", ".join(f"{k} {v:.2f}" for k, v in measured.items()))
        keyboard(browser)
        contrast(browser)
        shots(browser)
        quiet(browser, "with a file as camera")
    finally:
        browser.quit()
    browser = chromium()
    try:
        steering(browser)
        quiet(browser, "with a fake camera")
    finally:
        browser.quit()
    print(f"{len(failures)} failed")
    sys.exit(1 if failures else 0)


main()
