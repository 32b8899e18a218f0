// The page: passes frames from a source through the core, and shows the picture, the plot and the figures.

const at = (id) => document.getElementById(id);
const RGB_CODING = { matrix: MATRIX.BT601, range: RANGE.FULL };
const LAWS = [[VIEW.SECONDS, "Default, in seconds", "--adapted"], [VIEW.FORMULA_1, "Formula 1", "--one"],
    [VIEW.FORMULA_2, "Formula 2", "--two"], [VIEW.FORMULA_3, "Formulas 3 and 4", "--three"], [VIEW.EYE, "An eye", "--eye"]];
const STEP_S = 4, STEP_EV = -4, STILL_FPS = 30, FIRST_FRAME_MS = 4000;

// Exponential moving averages.
class Times {
    constructor() {
        this.ms = {};
    }

    add(name, ms) {
        this.ms[name] = this.ms[name] === undefined ? ms : this.ms[name] + 0.1 * (ms - this.ms[name]);
    }
}

class Page {
    constructor(core) {
        this.core = core;
        this.times = new Times();
        this.plot = new Plot(at("plot"));
        this.picture = new Picture(at("stage"), at("picture"), at("region"), (r) => this.meterAt(r));
        this.controls = new Controls(at("settings"), (name, value) => this.change(name, value), (e) => this.say(e));
        this.still = null;
        this.hasWindow = false; // the metering region is the still's own
        this.frames = null;
        this.exposure = null;
        this.recording = null;
        this.request = { late: false }; // the newest request for a source
        this.pending = null; // a video whose first frame has not arrived
        this.count = 0;
        this.lastDraw = 0;
        this.log = null; // set by tests: an array to which each frame's time and levels are added
    }

    // --- start ---

    start() {
        this.controls.defaults();
        const click = (id, run) => at(id).addEventListener("click", () => run().catch((e) => this.say(e)));
        click("use-scene", async () => {
            this.ask();
            this.showStill(testScene(), "Test scene");
        });
        click("use-camera", () => this.useCamera());
        click("use-file", async () => at("file").click());
        click("measure", () => this.measure());
        click("record", async () => this.record());
        at("file").addEventListener("change", () => this.open(at("file").files[0]));
        at("device").addEventListener("change", () => this.useCamera(at("device").value).catch((e) => this.say(e)));
        at("loop").addEventListener("change", () => this.steer(at("loop").checked));
        at("split").addEventListener("input", () => this.showSplit());
        at("light").addEventListener("input", () => this.showLight());
        at("laws-on").addEventListener("change", () => (at("laws").hidden = !at("laws-on").checked));
        for (const name of ["dragover", "drop"])
            document.addEventListener(name, (event) => event.preventDefault());
        document.addEventListener("drop", (event) => this.open(event.dataTransfer.files[0]));
        at("steps").checked = !matchMedia("(prefers-reduced-motion: reduce)").matches;
        this.makeLaws();
        this.showSplit();
        this.showLight();
        this.showStill(testScene(), "Test scene");
    }

    makeLaws() {
        this.lawCanvas = LAWS.map(([, name]) => {
            const figure = document.createElement("figure"), canvas = document.createElement("canvas");
            const caption = document.createElement("figcaption");
            canvas.setAttribute("role", "img");
            canvas.setAttribute("aria-label", `The picture by: ${name}`);
            figure.append(canvas, caption);
            at("laws").append(figure);
            return { canvas, caption };
        });
    }

    say(error) {
        at("message").textContent = error ? error.message : "";
        at("message").hidden = !error;
        if (error && !(error instanceof Error))
            throw error;
    }

    change(name, value) {
        this.core.set(name, value);
        if (name === "metering" && this.picture.region)
            this.picture.setRegion(null);
        this.redraw();
    }

    meterAt(region) {
        this.hasWindow = false;
        if (region)
            this.core.calls.region(region.x, region.y, region.width, region.height);
        else
            this.core.set("metering", Number(this.controls.inputs.metering.value));
    }

    // --- sources ---

    // Each request replaces the one before, which counts as late from then on.
    ask() {
        this.request.late = true;
        if (this.pending)
            release(this.pending);
        this.pending = null;
        return (this.request = { late: false });
    }

    stopSource() {
        cancelAnimationFrame(this.ticking);
        this.frames?.stop();
        this.still = this.frames = this.exposure = null;
        this.core.codeLight = 0;
        at("loop").checked = false;
        at("exposure").hidden = at("device").hidden = true;
        this.stopRecording("Another source was chosen");
        this.core.calls.reset();
        this.plot.points = [];
        this.say(null);
    }

    showStill(still, name) {
        this.stopSource();
        const floats = still.pixel === PIXEL.RGB32F;
        this.core.make(still.pixel, still.width, still.height);
        this.stops = floats && !still.codeLight ? stopsForUnit(still.data, still.width, still.height) : 0;
        const bytes = new Uint8Array(still.data.buffer, still.data.byteOffset, still.data.byteLength);
        this.core.bytes(this.core.lightAt, this.core.frameBytes).set(bytes);
        this.core.bytes(this.core.frameAt, this.core.frameBytes).set(bytes);
        this.still = still;
        if (still.window || this.hasWindow) // what a data window of OpenEXR leaves out is no part of the scene
            this.picture.setRegion(still.window ?? null);
        this.hasWindow = Boolean(still.window);
        this.count = 0;
        at("light-row").hidden = !floats;
        at("source-name").textContent = `${name}, ${still.width} x ${still.height}` +
            (this.stops ? `; the light is multiplied by 2^${this.stops}: it is far from 1` : "");
        const tick = () => {
            this.ticking = requestAnimationFrame(tick);
            const now = performance.now();
            if (now - this.lastDraw > 1000 / STILL_FPS - 4)
                this.stillFrame(now);
        };
        this.stillFrame(performance.now());
        tick();
    }

    // The slider and the steps change the light of the still. The gain is the factor of the unit (stopsForUnit).
    stillFrame(now) {
        const floats = this.still.pixel === PIXEL.RGB32F, seconds = now / 1000;
        if (!this.count)
            this.begun = seconds;
        const dark = at("steps").checked && Math.floor((seconds - this.begun) / STEP_S) % 2 === 1;
        const ev = floats ? at("light").valueAsNumber + (dark ? STEP_EV : 0) : 0;
        const began = performance.now();
        if (floats)
            this.core.calls.light(this.core.lightAt, this.core.frameAt, this.core.frameBytes / 4, 2 ** (ev + this.stops));
        this.core.codeLight = (this.still.codeLight ?? 0) * 2 ** ev;
        this.times.add("read", performance.now() - began);
        this.frame(RGB_CODING, BigInt(Math.round(now * 1e6)), this.stops ? 1 : 0, this.stops ? 2 ** this.stops : 0);
    }

    async open(file) {
        if (!file)
            return;
        const request = this.ask();
        try {
            if (!file.size)
                throw new Error("is empty");
            if (file.type.startsWith("video/")) {
                await this.useVideo(file, request);
            } else {
                const still = await readPicture(new Uint8Array(await file.arrayBuffer()));
                if (!request.late)
                    this.showStill(still, file.name);
            }
        } catch (error) {
            if (!request.late)
                this.say(new Error(`${file.name}: ${error.message}`));
        }
        at("file").value = "";
    }

    // Each source has its own element, so the old source stays on the page until the new one has a frame.
    makeVideo() {
        const video = at("video").cloneNode();
        video.removeAttribute("src");
        video.muted = true;
        return (this.pending = video);
    }

    async useVideo(file, request) {
        let first = null;
        const video = this.makeVideo(), why = "this browser cannot play it: pupil replay reads what FFmpeg reads";
        try {
            first = await new Promise((resolve, reject) => {
                video.requestVideoFrameCallback((now, metadata) => resolve(metadata));
                video.onerror = () => reject(new Error(why));
                setTimeout(() => reject(new Error(`no frame came in ${FIRST_FRAME_MS / 1000} s; ${why}`)), FIRST_FRAME_MS);
                Object.assign(video, { src: URL.createObjectURL(file), loop: true });
                video.play().catch(() => {}); // onerror reports why
            });
            checkSize(video.videoWidth, video.videoHeight);
        } catch (error) {
            release(video);
            throw error;
        }
        if (request.late) {
            release(video);
            return;
        }
        this.run(video, `${file.name}, ${video.videoWidth} x ${video.videoHeight}`, first);
        video.onerror = () => this.say(new Error(`${file.name}: ${why}`));
    }

    async useCamera(deviceId) {
        if (!navigator.mediaDevices?.getUserMedia)
            throw new Error("This browser gives this page no camera. Open it from https:// or http://localhost");
        const wanted = deviceId ? { deviceId: { exact: deviceId } } : { width: { ideal: 1280 }, height: { ideal: 720 } };
        const request = this.ask(), video = this.makeVideo();
        try {
            video.srcObject = await navigator.mediaDevices.getUserMedia({ video: wanted });
            if (!request.late)
                await video.play();
        } catch (error) {
            release(video);
            if (!request.late)
                throw new Error(`The camera cannot be used: ${error.message || error.name}`);
        }
        if (request.late) {
            release(video);
            return;
        }
        const track = video.srcObject.getVideoTracks()[0];
        this.run(video, `${track.label || "Camera"}, ${video.videoWidth} x ${video.videoHeight}`);
        this.exposure = new Exposure(track);
        track.addEventListener("ended", () => this.say(new Error("The camera has gone. Press Camera to look for it again.")));
        at("exposure").hidden = false;
        at("loop").disabled = !this.exposure.possible;
        at("loop-state").textContent = this.exposure.why;
        await this.listCameras(track.getSettings().deviceId, request);
    }

    async listCameras(now, request) {
        const cameras = (await navigator.mediaDevices.enumerateDevices()).filter((d) => d.kind === "videoinput");
        if (request.late)
            return;
        at("device").replaceChildren(...cameras.map((d, i) => new Option(d.label || `Camera ${i + 1}`, d.deviceId)));
        at("device").value = now;
        at("device").hidden = cameras.length < 2;
    }

    run(video, name, first) {
        this.stopSource();
        this.pending = null;
        at("video").replaceWith(video);
        at("light-row").hidden = true;
        at("source-name").textContent = name;
        this.count = 0;
        const frames = (this.frames = new VideoFrames(video));
        frames.start(async (read, timestampNs) => {
            const began = performance.now(), coding = await read(this.core);
            if (this.frames !== frames)
                return;
            this.times.add("read", performance.now() - began);
            this.frame(coding, timestampNs, 0, 0);
        }, (error) => this.say(error), first);
    }

    // --- a frame ---

    frame(coding, timestampNs, exposureS, gain) {
        const began = performance.now();
        this.coding = coding;
        this.core.take(coding);
        this.core.meter();
        const metered = performance.now();
        this.core.adapt(timestampNs, exposureS, gain);
        const adapted = performance.now();
        this.times.add("meter", metered - began);
        this.times.add("adapt", adapted - metered);
        this.timestampNs = timestampNs;
        this.log?.push([String(timestampNs), this.core.result(0, "metered_ev"), this.core.result(0, "adapted_ev")]);
        this.keep(timestampNs, exposureS, gain);
        this.stepExposure(timestampNs);
        const levels = Object.fromEntries(LAWS.map(([view, name]) => [name, this.core.result(view, "adapted_ev")]));
        this.plot.add(Number(timestampNs / 1000n) / 1e6, { metered: this.core.result(0, "metered_ev"), ...levels });
        this.draw();
        this.count++;
        const now = performance.now();
        this.times.add("frame", now - this.lastDraw);
        this.lastDraw = now;
        if (this.count % 6 === 1)
            this.showFigures();
    }

    draw() {
        const left = Number(at("left").value), began = performance.now();
        const right = this.core.map(VIEW.SECONDS, 0);
        const mapped = performance.now();
        this.times.add("map", mapped - began);
        this.picture.draw(right, this.picture.split ? this.core.map(left, 1) : null);
        this.times.add("draw", performance.now() - mapped);
        if (at("laws-on").checked)
            this.drawLaws();
        this.plot.draw(this.lines());
    }

    drawLaws() {
        LAWS.forEach(([view, name], i) => {
            const { canvas, caption } = this.lawCanvas[i], picture = this.core.map(view, 1);
            if (canvas.width !== picture.width || canvas.height !== picture.height)
                Object.assign(canvas, { width: picture.width, height: picture.height });
            canvas.getContext("2d").putImageData(picture, 0, 0);
            caption.textContent = `${name}: ${this.core.result(view, "adapted_ev").toFixed(2)} EV`;
        });
    }

    // After a change of a setting: maps the same frame again, without adapting.
    redraw() {
        if (this.count && this.core.pixel !== undefined)
            this.draw();
    }

    lines() {
        const laws = at("laws-on").checked ? LAWS.slice(1).map(([, name, colour]) => [name, colour, 1.5]) : [];
        return [["metered", "--metered", 1.5], ...laws, [LAWS[0][1], "--adapted", 3]];
    }

    // --- the camera's exposure ---

    steer(on) {
        const { exposure, core } = this;
        if (!exposure)
            return;
        if (!on) {
            exposure.giveBack();
            at("loop-state").textContent = "the camera's own automatic exposure";
            return;
        }
        const { least, most, step, gain } = exposure.limits, now = exposure.now;
        const frameS = 1 / (exposure.track.getSettings().frameRate || 30);
        const first = now.exposureS > 0 ? now.exposureS : Math.sqrt(least * most);
        if (core.calls.sensor_begin(frameS, least, most, step, gain, first, now.gain) !== 0) {
            at("loop").checked = false;
            this.say(new Error(`The camera's limits do not make sense: ${core.text(core.calls.why())}`));
            return;
        }
        exposure.ask(core.calls.sensor_result(0), core.calls.sensor_result(1));
    }

    stepExposure(timestampNs) {
        const { exposure, core } = this;
        if (!exposure || !at("loop").checked)
            return;
        const now = exposure.now;
        if (core.calls.sensor_frame(timestampNs, now.exposureS, now.gain) === 1)
            exposure.ask(core.calls.sensor_result(0), core.calls.sensor_result(1));
        const [asked, gain, error] = [0, 1, 2].map((i) => core.calls.sensor_result(i));
        const [state, reason] = [core.calls.sensor_state(), core.calls.sensor_reason()].map((t) => core.text(t));
        at("loop-state").textContent = exposure.refused ? `the browser refused: ${exposure.refused}`
            : `${state}${reason === "none" ? "" : `, ${reason}`}; asked ${(asked * 1e3).toFixed(1)} ms, gain ${gain.toFixed(1)}; ` +
              `the camera has ${(now.exposureS * 1e3).toFixed(1)} ms; ${error.toFixed(2)} EV off`;
    }

    // --- figures ---

    showSplit() {
        this.picture.split = at("split").valueAsNumber / 100;
        at("split-value").textContent = `${at("split").value} %`;
        at("part").hidden = !this.picture.split;
        at("part").style.left = `${at("split").value}%`;
        this.redraw();
    }

    showLight() {
        at("light-value").textContent = `${at("light").valueAsNumber.toFixed(1)} EV`;
        at("light").setAttribute("aria-valuetext", at("light-value").textContent);
    }

    showFigures() {
        const { core, times } = this, r = (name) => core.result(0, name), ms = times.ms;
        const state = STATES[r("state")], reason = REASONS[r("reason")];
        at("level").innerHTML = `<b>${r("adapted_ev").toFixed(2)} EV</b> adapted, ${r("metered_ev").toFixed(2)} EV metered; ` +
            `${state}${reason ? `, ${reason}` : ""}. Clipped ${(100 * r("clipped_share")).toFixed(1)} %, black ` +
            `${(100 * r("black_share")).toFixed(1)} %${r("bad_share") ? `, NaN or infinite ${(100 * r("bad_share")).toFixed(1)} %` : ""}`;
        const pixels = core.width * core.height, perPixel = ((ms.meter + ms.map) * 1e6) / pixels;
        const rows = [["Read the frame", ms.read, "ms"], ["Meter", ms.meter, "ms"], ["Adapt, all laws", ms.adapt, "ms"],
            ["Map", ms.map, "ms"], ["Draw, with the left side", ms.draw, "ms"], ["Meter and map", perPixel, "ns a pixel"],
            ["Frames", 1000 / ms.frame, "a second"]];
        at("numbers").tBodies[0].replaceChildren(...rows.map(([name, value, unit]) => this.tableRow(name,
            `${value.toFixed(2)} ${unit}`)), this.tableRow("Frame", `${core.width} x ${core.height}`),
            this.tableRow("Kernels", core.level));
        at("legend").replaceChildren(...this.lines().map(([name, colour]) => this.legend(name, colour)));
    }

    tableRow(name, value) {
        const row = document.createElement("tr"), cells = [document.createElement("td"), document.createElement("td")];
        cells[0].textContent = name;
        cells[1].textContent = value;
        cells[1].className = "number";
        row.append(...cells);
        return row;
    }

    legend(name, colour) {
        const item = document.createElement("li"), mark = document.createElement("i");
        const ev = this.plot.points.at(-1)?.levels[name];
        mark.style.borderColor = `var(${colour})`;
        item.append(mark, `${name === "metered" ? "Metered" : name}: ${ev?.toFixed(2)} EV`);
        return item;
    }

    // Times the scalar and the vector kernels on the current frame: the fastest of five rounds of at least 60 ms each.
    async measure() {
        const levels = this.core.level === "scalar" ? [0] : [0, LEVELS.indexOf(this.core.level)], ns = {};
        at("measured").textContent = "measuring ...";
        await new Promise((resolve) => setTimeout(resolve, 50));
        for (let round = 0; round < 5; round++)
            for (const level of levels) {
                this.core.set("levels", 1 << level);
                for (const [name, run] of [["meter", () => this.core.meter()], ["map", () => this.core.map(0, 0)]]) {
                    const began = performance.now();
                    let frames = 0, passed = 0;
                    for (; passed < 60; frames++, passed = performance.now() - began)
                        run();
                    const key = `${LEVELS[level]} ${name}`, one = (passed * 1e6) / frames / (this.core.width * this.core.height);
                    ns[key] = Math.min(ns[key] ?? Infinity, one);
                }
            }
        this.core.set("levels", 0);
        this.measured = ns;
        at("measured").textContent = `ns a pixel: ${Object.entries(ns).map(([key, v]) => `${key} ${v.toFixed(2)}`).join(", ")}`;
    }

    // Resets the adaptation, so that a replay, which starts with the recording, has the same levels.
    record() {
        const button = at("record");
        if (!this.recording && !RECORDED[this.core.pixel])
            throw new Error("Frames of this format are not recorded");
        if (!this.recording) {
            this.core.calls.reset();
            this.recording = new Recording(this.core, this.coding);
            this.setRecording(button, true);
            return;
        }
        this.stopRecording("");
    }

    setRecording(button, on) {
        button.textContent = on ? "Stop and save" : "Record what is metered";
        button.setAttribute("aria-pressed", String(on));
    }

    // Saves the recording. why: what ended it, if not the button.
    stopRecording(why) {
        const recording = this.recording, frames = recording?.lines.length;
        this.recording = null;
        this.setRecording(at("record"), false);
        if (frames === 0)
            at("recorded").textContent = "No frame came: nothing is saved";
        if (!frames)
            return;
        const link = document.createElement("a");
        Object.assign(link, { href: URL.createObjectURL(recording.tar()), download: "pupil-recording.tar" });
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 10000);
        at("recorded").textContent = `${why ? `${why}: ` : ""}${frames} ${frames === 1 ? "frame" : "frames"} in ` +
            "pupil-recording.tar: tar xf pupil-recording.tar; pupil replay pupil-recording";
    }

    keep(timestampNs, exposureS, gain) {
        const recording = this.recording;
        if (!recording)
            return;
        const same = recording.add(this.core, timestampNs, exposureS, gain);
        at("recorded").textContent = `${recording.lines.length} of at most ${recording.most} frames`;
        if (!same)
            this.stopRecording("Frames of another size came");
        else if (recording.full)
            this.stopRecording(`The limit of ${recording.limit} is reached`);
    }
}

Core.load().then((core) => {
    window.pupil = new Page(core); // for the browser's console
    window.pupil.start();
}).catch((error) => {
    at("message").textContent = `The core does not start in this browser: ${error.message}`;
    at("message").hidden = false;
});
