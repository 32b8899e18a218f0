// The metered frames as a recording for pupil replay (docs/recording.md), in a tar archive: frames.mkv (Matroska, RFC
// 9559), frames.jsonl with the exact times, recording.json.

const RECORDED = {
    [PIXEL.I420]: { name: "i420", fourcc: "I420" },
    [PIXEL.NV12]: { name: "nv12", fourcc: "NV12" },
    [PIXEL.RGBA8]: { name: "rgba8", fourcc: "RGBA" },
    [PIXEL.RGB8]: { name: "rgb8", fourcc: "RGB\x18" },
    [PIXEL.RGB32F]: { name: "rgb32f", fourcc: "RGB\x60" },
};
const MOST_RECORDED_FRAMES = 300, MOST_RECORDED_BYTES = 2 ** 28;

function bytesOfText(text) {
    return Uint8Array.from(text, (c) => c.charCodeAt(0));
}

function bytesOfNumber(number, count) {
    return Uint8Array.from({ length: count }, (_, i) => Math.floor(number / 256 ** (count - 1 - i)) % 256);
}

// A Matroska element: ID, length in 8 bytes, and content, which may be bytes, a text, a number, or elements.
function element(id, ...content) {
    const parts = content.map((c) => (typeof c === "number" ? bytesOfNumber(c, 4)
        : typeof c === "string" ? bytesOfText(c) : c)).flat();
    const length = parts.reduce((sum, p) => sum + p.length, 0), size = bytesOfNumber(length, 8);
    size[0] = 1;
    return [bytesOfNumber(id, Math.ceil((32 - Math.clz32(id)) / 8)), size, ...parts];
}

function matroskaHead(pixel, width, height) {
    const video = element(0xe0, element(0xb0, width), element(0xba, height), element(0x2eb524, RECORDED[pixel].fourcc));
    const track = element(0xae, element(0xd7, 1), element(0x73c5, 1), element(0x83, 1), element(0x86, "V_UNCOMPRESSED"), video);
    const unknown = Uint8Array.of(0x18, 0x53, 0x80, 0x67, 1, 255, 255, 255, 255, 255, 255, 255); // a segment of unknown length
    return [...element(0x1a45dfa3, element(0x4286, 1), element(0x42f7, 1), element(0x42f2, 4), element(0x42f3, 8),
        element(0x4282, "matroska"), element(0x4287, 4), element(0x4285, 2)), unknown,
        ...element(0x1549a966, element(0x2ad7b1, 1000000), element(0x4d80, "pupil"), element(0x5741, "pupil")),
        ...element(0x1654ae6b, track)];
}

function matroskaFrame(ms, bytes) {
    return element(0x1f43b675, element(0xe7, ms), element(0xa3, Uint8Array.of(0x81, 0, 0, 0x80), bytes));
}

// A file in a tar archive (POSIX.1-1988, ustar), with the padding of its last block.
function tarFile(name, blob) {
    const head = new Uint8Array(512), put = (at, text) => head.set(bytesOfText(text), at);
    const octal = (number, digits) => `${number.toString(8).padStart(digits, "0")}\0`;
    put(0, name);
    put(100, octal(0o644, 7) + octal(0, 7) + octal(0, 7) + octal(blob.size, 11) + octal(0, 11) + "        0");
    put(257, "ustar\x0000");
    put(148, `${head.reduce((sum, b) => sum + b, 0).toString(8).padStart(6, "0")}\0 `);
    return [head, blob, new Uint8Array((512 - (blob.size % 512)) % 512)];
}

class Recording {
    constructor(core, coding) {
        Object.assign(this, { coding, pixel: core.pixel, width: core.width, height: core.height });
        this.parts = matroskaHead(core.pixel, core.width, core.height);
        this.lines = [];
        this.settings = { ...core.settings };
        this.ms = -1;
        const fit = Math.max(1, Math.floor(MOST_RECORDED_BYTES / core.frameBytes));
        this.most = Math.min(MOST_RECORDED_FRAMES, fit);
        this.limit = fit < MOST_RECORDED_FRAMES ? `${MOST_RECORDED_BYTES / 2 ** 20} MiB` : `${MOST_RECORDED_FRAMES} frames`;
    }

    get full() {
        return this.lines.length >= this.most;
    }

    // False if the frame has another size or format than the first one: a recording has only one.
    add(core, timestampNs, exposureS, gain) {
        if (core.pixel !== this.pixel || core.width !== this.width || core.height !== this.height)
            return false;
        this.begun ??= timestampNs;
        const ns = timestampNs - this.begun, frame = this.lines.length;
        this.ms = Math.max(Number(ns / 1000000n), this.ms + 1);
        this.parts.push(...matroskaFrame(this.ms, core.bytes(core.frameAt, core.frameBytes).slice()));
        this.lines.push(`{"frame":${frame},"sequence":${frame},"timestamp_ns":${ns},"exposure_s":${exposureS},"gain":${gain}}\n`);
        return true;
    }

    about() {
        return JSON.stringify({ format: "pupil recording", version: 1, camera: "the page", pixel: RECORDED[this.pixel].name,
            width: this.width, height: this.height, fps: 30, stored: "raw", matrix: ["bt601", "bt709", "bt2020"][this.coding.matrix],
            range: ["limited", "full"][this.coding.range], light: "usual", bayer: "rggb", shift: 0, black: 0, white: 0,
            balance: [0, 0, 0], rgb_from_camera: [0, 0, 0, 0, 0, 0, 0, 0, 0], page_settings: this.settings }, null, 1);
    }

    tar() {
        const folder = "pupil-recording", files = [["recording.json", new Blob([this.about()])],
            ["frames.jsonl", new Blob(this.lines)], ["frames.mkv", new Blob(this.parts)]];
        return new Blob([...files.flatMap(([name, blob]) => tarFile(`${folder}/${name}`, blob)), new Uint8Array(1024)]);
    }
}
