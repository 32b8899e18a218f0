// The functions that page.c exports. SETTINGS and RESULTS are in the order of that file.

const PIXEL = { RGB32F: 2, RGBA8: 6, RGB8: 7, NV12: 10, I420: 22 };
const MATRIX = { BT601: 0, BT709: 1, BT2020: 2 };
const RANGE = { LIMITED: 0, FULL: 1 };
const LEVELS = ["scalar", "neon", "avx2", "avx512", "wasm128"];
const SETTINGS = ["ev_compensation", "key", "tau_light_s", "tau_dark_s", "frame_weight", "ev_min", "ev_max", "highlight_ev",
    "white_quantile", "eye_unit_cd_m2", "lock", "white_mode", "curve", "flicker", "levels", "metering"];
const RESULTS = ["metered_ev", "adapted_ev", "white_ev", "scale", "dt_s", "state", "reason", "held_back_ev", "flicker_ev",
    "black_share", "clipped_share", "bad_share"];
const STATES = ["empty", "adapting", "settled", "limited", "locked"];
const REASONS = ["", "at the lowest level", "at the highest level", "no light", "the clock went back", "locked",
    "timestamps too close", "held back by highlights", "no histogram", "too dark: mostly noise", "out of range"];
// What a view shows: an engine of each law, a locked one, or the frame itself.
const VIEW = { SECONDS: 0, FORMULA_1: 1, FORMULA_2: 2, FORMULA_3: 3, FORMULA_4: 4, EYE: 5, LOCKED: 6, AS_IT_CAME: 7 };

function bytesOfBase64(text) {
    return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

class Core {
    // Loads the module with vectors if the browser supports them.
    static async load() {
        const vectors = bytesOfBase64(PAGE_WASM128);
        const bytes = WebAssembly.validate(vectors) ? vectors : bytesOfBase64(PAGE_SCALAR);
        const { instance } = await WebAssembly.instantiate(bytes, {});
        return new Core(instance.exports);
    }

    constructor(calls) {
        this.calls = calls;
        this.settings = {};
        this.codeLight = 0; // of floats that were codes: their first code's light
        calls.begin();
    }

    get level() {
        return LEVELS[this.calls.level()];
    }

    bytes(at, length) {
        return new Uint8Array(this.calls.memory.buffer, at, length);
    }

    text(at) {
        const all = new Uint8Array(this.calls.memory.buffer);
        return new TextDecoder().decode(all.slice(at, all.indexOf(0, at)));
    }

    set(name, value) {
        if (this.calls.set(SETTINGS.indexOf(name), value) !== 0)
            throw new Error(this.text(this.calls.why()));
        this.settings[name] = value;
    }

    // Allocates memory for a frame, for its original light, and for two pictures.
    make(pixel, width, height) {
        const frame = this.calls.image_bytes(pixel, width, height), picture = width * height * 4;
        if (!frame)
            throw new Error(`${width} x ${height} pixels: from 1 x 1 to 16384 x 16384 are shown`);
        const align = (n) => (n + 63) & ~63;
        const base = this.calls.room(2 * align(frame) + 2 * align(picture));
        if (!base)
            throw new Error(`${width} x ${height} pixels: the browser has not enough memory for them`);
        this.pixel = pixel;
        this.width = width;
        this.height = height;
        this.frameBytes = frame;
        this.frameAt = base;
        this.lightAt = base + align(frame);
        this.pictureAt = [base + 2 * align(frame), base + 2 * align(frame) + align(picture)];
    }

    // Makes the bytes at frameAt the current frame. coding: for Y'CbCr.
    take(coding) {
        this.calls.frame(this.frameAt, this.pixel, this.width, this.height, coding.matrix, coding.range);
    }

    meter() {
        this.check(this.calls.meter(this.codeLight));
    }

    adapt(timestampNs, exposureS, gain) {
        this.check(this.calls.adapt(timestampNs, exposureS, gain));
    }

    // Maps into one of the two pictures, and returns it as ImageData.
    map(view, which) {
        this.check(this.calls.map(view, this.pictureAt[which]));
        const bytes = this.width * this.height * 4;
        return new ImageData(new Uint8ClampedArray(this.calls.memory.buffer, this.pictureAt[which], bytes), this.width,
            this.height);
    }

    result(view, name) {
        return this.calls.result(view, RESULTS.indexOf(name));
    }

    check(result) {
        if (result !== 0)
            throw new Error(`the core refused a frame (${result})`);
    }
}
