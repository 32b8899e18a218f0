// Reads Radiance pictures and portable float maps, as drivers/file/still/read_radiance.c and read_pfm.c do.

// Reads lines and words of a header.
class HeaderText {
    constructor(bytes) {
        this.bytes = bytes;
        this.at = 0;
    }

    line() {
        const end = this.bytes.indexOf(10, this.at);
        if (end < 0)
            return null;
        const text = String.fromCharCode(...this.bytes.subarray(this.at, Math.min(end, this.at + 256)));
        this.at = end + 1;
        return text.replace(/\r$/, "");
    }

    word() {
        const space = (c) => c === 32 || (c >= 9 && c <= 13), start = () => this.at < this.bytes.length;
        while (start() && space(this.bytes[this.at]))
            this.at++;
        const from = this.at;
        while (start() && !space(this.bytes[this.at]) && this.at - from < 31)
            this.at++;
        return String.fromCharCode(...this.bytes.subarray(from, this.at)).replace(/[^ -~]/g, "?");
    }
}

function headerOfRadiance(text) {
    const header = { divide: [1, 1, 1], xy: null };
    if (!text.line()?.startsWith("#?"))
        throw new Error('a Radiance file must begin with a line "#?RADIANCE"');
    for (let line; (line = text.line()) !== "";) {
        if (line === null)
            throw new Error("the Radiance header does not end with an empty line");
        const [, name, value] = /^([A-Z]+)=\s*(.*)$/.exec(line) ?? [];
        const numbers = (value ?? "").trim().split(/\s+/).map(Number);
        if (name === "FORMAT" && !/^32-bit_rle_(rgbe|xyze)/.test(value))
            throw new Error(`FORMAT is "${value.slice(0, 60)}"; 32-bit_rle_rgbe and 32-bit_rle_xyze are read`);
        else if (name === "FORMAT" && value.startsWith("32-bit_rle_xyze"))
            header.xy = [1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3];
        else if (name === "EXPOSURE" && value && numbers[0] === 0)
            continue; // unknown
        else if (name === "EXPOSURE" || name === "COLORCORR")
            header.divide = header.divide.map((d, c) => d * numbers[name === "EXPOSURE" ? 0 : c]);
        else if (name === "PRIMARIES" && numbers.length >= 8)
            header.xy ??= numbers.slice(0, 8);
        if (!header.divide.every((d) => d > 1e-30 && d < 1e30))
            throw new Error(`"${line.slice(0, 60)}" is no number above 0`);
    }
    return header;
}

function resolutionOfRadiance(text) {
    const line = text.line(), m = /^\s*([-+])([XY])\s*(\d+)\s*([-+])([XY])\s*(\d+)\s*$/.exec(line ?? "");
    if (!m || m[2] === m[5])
        throw new Error(`the resolution line "${(line ?? "").slice(0, 60).replace(/[^ -~]/g, "?")}" is not of the form ` +
            '"-Y 512 +X 1024"');
    const lines = +m[3], pixels = +m[6], width = m[2] === "Y" ? pixels : lines, height = m[2] === "Y" ? lines : pixels;
    checkSize(width, height);
    let first = 0;
    const steps = [[m[1], m[2], lines], [m[4], m[5], pixels]].map(([sign, axis, count]) => {
        const step = axis === "Y" ? width : 1, backwards = sign === (axis === "Y" ? "+" : "-");
        first += backwards ? (count - 1) * step : 0;
        return backwards ? -step : step;
    });
    return { lines, pixels, width, height, first, lineStep: steps[0], pixelStep: steps[1] };
}

// A line in the old encoding: plain pixels; 1 1 1 n repeats the one before n times. Returns a fault or null.
function oldLine(r, line, pixels) {
    for (let done = 0, shift = 0; done < pixels; r.at += 4) {
        const b = r.bytes.subarray(r.at, r.at + 4);
        if (b.length < 4)
            return "ends early";
        if (b[0] === 1 && b[1] === 1 && b[2] === 1) {
            const count = b[3] * 2 ** shift;
            if (!done)
                return "begins with a repeat";
            if (count > pixels - done)
                return "has a run over its end";
            for (let i = 0; i < count; i++, done++)
                line.copyWithin(4 * done, 4 * (done - 1), 4 * done);
            shift += 8;
        } else {
            line.set(b, 4 * done++);
            shift = 0;
        }
    }
    return null;
}

// A line in the new encoding: the four components one after the other; a count above 128 is a run.
function newLine(r, line, pixels) {
    r.at += 4;
    for (let component = 0; component < 4; component++)
        for (let done = 0; done < pixels;) {
            const code = r.bytes[r.at++], run = code > 128, count = run ? code - 128 : code;
            if (r.at >= r.bytes.length)
                return "ends early";
            if (!count)
                return "has a run of no length";
            if (count > pixels - done)
                return "has a run over its end";
            if (!run && r.at + count > r.bytes.length)
                return "ends early";
            for (let i = 0; i < count; i++, done++)
                line[4 * done + component] = r.bytes[run ? r.at : r.at + i];
            r.at += run ? 1 : count;
        }
    return null;
}

function anyLine(r, line, pixels) {
    const b = r.bytes.subarray(r.at, r.at + 4);
    if (pixels < 8 || pixels > 32767 || b.length < 4 || b[0] !== 2 || b[1] !== 2 || b[2] > 127)
        return oldLine(r, line, pixels);
    return b[2] * 256 + b[3] === pixels ? newLine(r, line, pixels)
        : "is marked with another length than the resolution line";
}

async function readRadiance(bytes) {
    const text = new HeaderText(bytes), header = headerOfRadiance(text), size = resolutionOfRadiance(text);
    const { lines, pixels, width, height } = size, data = new Float32Array(width * height * 3);
    const scale = Array.from({ length: 256 }, (_, e) => header.divide.map((d) => (e ? 2 ** (e - 136) / d : 0)));
    const r = { bytes, at: text.at }, line = new Uint8Array(4 * pixels);
    for (let i = 0; i < lines; i++) {
        const fault = anyLine(r, line, pixels);
        if (fault)
            throw new Error(`scanline ${i + 1} of ${lines} ${fault}`);
        for (let j = 0; j < pixels; j++)
            for (let c = 0; c < 3; c++)
                data[3 * (size.first + i * size.lineStep + j * size.pixelStep) + c] =
                    line[4 * j + c] * scale[line[4 * j + 3]][c];
    }
    convertTo709(data, matrixToRec709(header.xy));
    return { width, height, pixel: PIXEL.RGB32F, data };
}

async function readPfm(bytes) {
    const text = new HeaderText(bytes), channels = { PF: 3, Pf: 1, PF4: 4 }[text.word()];
    if (!channels)
        throw new Error("the PFM header must begin with a line PF, Pf or PF4");
    const [width, height] = ["width", "height"].map((side) => {
        const word = text.word();
        if (!/^\d+$/.test(word))
            throw new Error(`the PFM header's ${side} "${word}" is no whole number of pixels`);
        if (word.length > 9)
            throw new Error(`the PFM header's ${side} begins with ${word}; at most 16384 pixels a side are read`);
        return +word;
    });
    checkSize(width, height);
    const word = text.word(), scale = Number(word), need = width * height * channels * 4;
    if (!word || !Number.isFinite(scale) || scale === 0)
        throw new Error(`the PFM header's scale "${word}" is no number above or below 0 (-1.0 is usual)`);
    let start = text.at + 1;
    if (bytes[start - 1] === 13 && bytes[start] === 10 && bytes.length - start > need)
        start++;
    if (bytes.length - start < need)
        throw new Error(`${width} x ${height} pixels need ${need} bytes of samples; the file has ` +
            `${Math.max(0, bytes.length - start)}`);
    const view = new DataView(bytes.buffer, bytes.byteOffset + start, need);
    const data = new Float32Array(width * height * 3);
    for (let y = 0, i = 0; y < height; y++)
        for (let x = 0; x < width; x++)
            for (let c = 0; c < 3; c++, i++)
                data[i] = view.getFloat32(4 * (((height - 1 - y) * width + x) * channels + (channels === 1 ? 0 : c)), scale < 0);
    return { width, height, pixel: PIXEL.RGB32F, data };
}
