// Reads OpenEXR of one part, scanlines or tiles of one level, to linear light (openexr.com, "OpenEXR File Layout"), with
// the result of drivers/file/still/read_exr.c. B44, DWA, several parts and chroma of half the size are refused by name.

const EXR_COMPRESSIONS = ["none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"];
const EXR_LINES = [1, 1, 1, 16, 32, 16, 32, 32, 32, 256]; // of a chunk
const EXR_BYTES = [4, 2, 4]; // of a sample: uint, half, float

const HALF_TO_FLOAT = Float32Array.from({ length: 65536 }, (_, h) => {
    const sign = h & 0x8000 ? -1 : 1, exponent = (h >> 10) & 31, fraction = h & 1023;
    return sign * (exponent === 31 ? (fraction ? NaN : Infinity)
        : exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * (fraction / 1024));
});

function damagedExr(what) {
    return new Error(`is damaged as an OpenEXR file: ${what}`);
}

// Reads numbers and names, and throws at the end of the data.
class ExrBytes {
    constructor(bytes) {
        this.bytes = bytes;
        this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
        this.at = 0;
    }

    take(count) {
        if (!(count >= 0 && count <= this.bytes.length - this.at))
            throw damagedExr("it ends early");
        this.at += count;
        return this.at - count;
    }

    byte() {
        return this.view.getUint8(this.take(1));
    }

    int() {
        return this.view.getInt32(this.take(4), true);
    }

    float() {
        return this.view.getFloat32(this.take(4), true);
    }

    name() {
        const end = this.bytes.indexOf(0, this.at);
        if (end < 0 || end - this.at > 255)
            throw damagedExr("a name in its header does not end");
        const from = this.take(end + 1 - this.at);
        return String.fromCharCode(...this.bytes.subarray(from, end)).replace(/[^ -~]/g, "?");
    }
}

function channelsOfExr(r) {
    const list = [];
    while (r.bytes[r.at]) {
        const name = r.name(), type = r.int();
        r.take(4);
        const stepX = r.int(), stepY = r.int();
        if (!EXR_BYTES[type] || stepX < 1 || stepY < 1)
            throw damagedExr(`its channel ${name} is of no known kind`);
        list.push({ name, type, stepX, stepY, bytes: EXR_BYTES[type] });
    }
    return list;
}

const EXR_ATTRIBUTES = {
    channels: channelsOfExr,
    compression: (r) => r.byte(),
    dataWindow: (r) => [r.int(), r.int(), r.int(), r.int()],
    displayWindow: (r) => [r.int(), r.int(), r.int(), r.int()],
    chromaticities: (r) => Array.from({ length: 8 }, () => r.float()),
    type: (r, size) => String.fromCharCode(...r.bytes.subarray(r.take(Math.min(size, 32)), r.at)),
    tiles: (r) => ({ width: r.int(), height: r.int(), mode: r.byte() }),
};

function headerOfExr(r) {
    const header = {}, flags = (r.take(4), r.int());
    if (flags & 0x1800)
        throw new Error("has several parts or deep data: pupil replay reads several parts, and none reads deep data");
    while (r.bytes[r.at] !== 0 || r.at >= r.bytes.length) {
        const name = r.name(), type = r.name(), size = r.int(), end = r.at + size;
        if (size < 0 || end > r.bytes.length)
            throw damagedExr(`its attribute ${name} (${type}) does not end`);
        if (EXR_ATTRIBUTES[name])
            header[name] = EXR_ATTRIBUTES[name](r, size);
        r.at = end;
    }
    r.take(1);
    for (const name of ["channels", "compression", "dataWindow", "displayWindow"])
        if (header[name] === undefined)
            throw damagedExr(`its header has no ${name}`);
    header.tiled = (flags & 0x200) !== 0;
    if (![undefined, header.tiled ? "tiledimage" : "scanlineimage"].includes(header.type))
        throw damagedExr("what its header says of its kind does not agree");
    return header;
}

// The picture's channels: R, G, B, or Y for all three, without a layer's name, else of the first layer that has them.
function picked(channels) {
    const layers = ["", ...channels.map((c) => c.name.slice(0, c.name.lastIndexOf(".") + 1))];
    for (const layer of layers)
        for (const names of [["R", "G", "B"], ["Y", "Y", "Y"]]) {
            const found = names.map((n) => channels.findIndex((c) => c.name === layer + n));
            const has = (n) => channels.some((c) => c.name === layer + n);
            const isOther = (has("RY") && has("BY")) || (has("X") && has("Z")); // chroma; CIE XYZ or normals
            if (found.every((i) => i >= 0) && !(names[0] === "Y" && isOther))
                return found;
        }
    const list = channels.map((c) => c.name).join(", ").slice(0, 200);
    throw new Error(`has the channels ${list}; R, G and B, or Y alone, are read here`);
}

// Undoes the predictor: sums the differences, and interleaves the two halves.
function unpredicted(bytes) {
    const out = new Uint8Array(bytes.length), half = (bytes.length + 1) >> 1;
    for (let i = 1; i < bytes.length; i++)
        bytes[i] += bytes[i - 1] - 128;
    for (let i = 0; i < bytes.length; i++)
        out[i] = bytes[i & 1 ? half + (i >> 1) : i >> 1];
    return out;
}

function unRle(bytes, size) {
    const out = new Uint8Array(size);
    let at = 0, to = 0;
    while (at < bytes.length) {
        const count = (bytes[at++] << 24) >> 24, length = count < 0 ? -count : count + 1;
        if (to + length > size || (count < 0 ? at + length : at + 1) > bytes.length)
            throw damagedExr("a run does not end where it should");
        if (count < 0)
            out.set(bytes.subarray(at, at + length), to);
        else
            out.fill(bytes[at], to, to + length);
        at += count < 0 ? length : 1;
        to += length;
    }
    return to === size ? out : null;
}

// PXR24: per line and channel, byte planes of differences, most significant first; floats lack their last 8 bits.
function unPxr24(bytes, block) {
    const out = new Uint8Array(block.bytes), view = new DataView(out.buffer);
    let at = 0, to = 0;
    for (let y = 0; y < block.height; y++)
        for (const c of block.channels) {
            const planes = c.type === 2 ? 3 : c.bytes;
            for (let x = 0, value = 0; x < block.width; x++, to += c.bytes) {
                for (let p = 0; p < planes; p++)
                    value += bytes[at + p * block.width + x] << (8 * (planes - 1 - p));
                if (c.bytes === 2)
                    view.setUint16(to, value, true);
                else
                    view.setUint32(to, c.type === 2 ? value << 8 : value, true);
            }
            at += planes * block.width;
        }
    return out;
}

// Decompresses a tile or a group of lines: samples line by line and channel by channel.
async function exrBlock(compression, bytes, block) {
    let out = null;
    if (bytes.length === block.bytes || compression === 0)
        out = bytes;
    else if (compression === 1)
        out = unRle(bytes, block.bytes);
    else if (compression === 4)
        return unPiz(bytes, block);
    else
        out = await inflated(bytes);
    if (out && compression === 5 && out !== bytes)
        return unPxr24(out, block);
    if (out?.length !== block.bytes)
        throw damagedExr("a chunk has another size than its pixels");
    return out === bytes ? out : unpredicted(out);
}

// Copies the part of a block that is inside the picture.
function placeBlock(header, which, samples, block, to, size) {
    const view = new DataView(samples.buffer, samples.byteOffset, samples.byteLength), [left, top] = header.displayWindow;
    const lineBytes = block.bytes / block.height;
    let first = 0;
    const starts = header.channels.map((c) => (first += c.bytes * block.width) - c.bytes * block.width);
    for (let y = 0; y < block.height; y++) {
        const row = block.y + y - top;
        for (let c = 0; c < 3 && row >= 0 && row < size.height; c++) {
            const channel = header.channels[which[c]];
            for (let x = 0, at = y * lineBytes + starts[which[c]]; x < block.width; x++, at += channel.bytes) {
                const column = block.x + x - left;
                if (column >= 0 && column < size.width)
                    to[3 * (row * size.width + column) + c] = channel.type === 1 ? HALF_TO_FLOAT[view.getUint16(at, true)]
                        : channel.type === 2 ? view.getFloat32(at, true) : view.getUint32(at, true);
            }
        }
    }
}

function checkExr(header, which, fileBytes) {
    const [x0, y0, x1, y1] = header.dataWindow, [a0, b0, a1, b1] = header.displayWindow;
    if (x1 < x0 || y1 < y0 || a1 < a0 || b1 < b0)
        throw new Error("has an empty data window or display window");
    checkSize(x1 - x0 + 1, y1 - y0 + 1);
    checkSize(a1 - a0 + 1, b1 - b0 + 1);
    if (x1 < a0 || x0 > a1 || y1 < b0 || y0 > b1)
        throw new Error("has a data window wholly outside its display window");
    const compression = EXR_COMPRESSIONS[header.compression];
    if (!compression || header.compression > 5)
        throw new Error(`is compressed as ${compression ?? "nothing that is known"}: none, RLE, ZIPS, ZIP, PIZ and PXR24 are ` +
            "read here");
    for (const c of header.channels)
        if (c.stepX !== 1 || c.stepY !== 1)
            throw new Error(`has channel ${c.name} sampled every ${c.stepX} x ${c.stepY} pixels; every pixel must have it`);
    const bytes = header.channels.reduce((sum, c) => sum + c.bytes, 0);
    if (((x1 - x0 + 1) * (y1 - y0 + 1) * bytes) / 1400 > fileBytes)
        throw new Error(`the header promises ${x1 - x0 + 1} x ${y1 - y0 + 1} pixels, more than ${fileBytes} bytes can hold`);
    if (header.tiled && !(header.tiles?.width > 0 && header.tiles.height > 0 && (header.tiles.mode & 15) === 0))
        throw new Error("has tiles of several levels, or of no size: tiles of one level are read here");
    return bytes;
}

// What the data window has of the picture, in shares of it; null: all.
function windowOfExr(header) {
    const [x0, y0, x1, y1] = header.dataWindow, [left, top, right, bottom] = header.displayWindow;
    if (x0 <= left && y0 <= top && x1 >= right && y1 >= bottom)
        return null;
    const x = Math.max(x0, left), y = Math.max(y0, top), width = right - left + 1, height = bottom - top + 1;
    return { x: (x - left) / width, y: (y - top) / height, width: (Math.min(x1, right) + 1 - x) / width,
        height: (Math.min(y1, bottom) + 1 - y) / height };
}

async function readExr(bytes) {
    const r = new ExrBytes(bytes), header = headerOfExr(r), which = picked(header.channels);
    const pixelBytes = checkExr(header, which, bytes.length);
    const [x0, y0, x1, y1] = header.dataWindow, [left, top, right, bottom] = header.displayWindow;
    const size = { width: right - left + 1, height: bottom - top + 1 };
    const wide = header.tiled ? header.tiles.width : x1 - x0 + 1;
    const high = header.tiled ? header.tiles.height : EXR_LINES[header.compression];
    const across = Math.ceil((x1 - x0 + 1) / wide), count = across * Math.ceil((y1 - y0 + 1) / high);
    const data = new Float32Array(size.width * size.height * 3), seen = new Set();
    r.take(8 * count); // skips the chunks' offsets: chunks follow one another
    for (let i = 0; i < count; i++) {
        const place = header.tiled ? [r.int(), r.int(), r.int(), r.int()] : [0, (r.int() - y0) / high];
        const block = { x: x0 + place[0] * wide, y: y0 + place[1] * high, channels: header.channels };
        block.width = Math.min(wide, x1 + 1 - block.x);
        block.height = Math.min(high, y1 + 1 - block.y);
        if (!(place[0] >= 0 && place[1] >= 0 && block.width > 0 && block.height > 0 && Number.isInteger(place[1])))
            throw damagedExr("a chunk is outside the picture");
        block.bytes = block.width * block.height * pixelBytes;
        const length = r.int(), from = r.take(length);
        const samples = await exrBlock(header.compression, bytes.slice(from, from + length), block);
        placeBlock(header, which, samples, block, data, size);
        seen.add(place.join());
    }
    if (seen.size !== count)
        throw damagedExr("a chunk is there twice, and another one is missing");
    if (which[0] !== which[1])
        convertTo709(data, matrixOfExr(header.chromaticities));
    return { width: size.width, height: size.height, pixel: PIXEL.RGB32F, data, window: windowOfExr(header) };
}
