// Reads PNG of 1 to 16 bits to linear light, as drivers/file/still/read_png.c does: by cICP, else sRGB, else gAMA and
// cHRM. 8-bit sRGB is not converted; the core decodes it.

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
    for (let k = 0; k < 8; k++)
        n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
    return n;
});

function crcOf(bytes) {
    let crc = 0xffffffff;
    for (const b of bytes)
        crc = CRC_TABLE[(crc ^ b) & 255] ^ (crc >>> 8);
    return (crc ^ 0xffffffff) >>> 0;
}

// Decompresses zlib data; null if they are damaged.
async function inflated(bytes) {
    try {
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
        return new Uint8Array(await new Response(stream).arrayBuffer());
    } catch {
        return null;
    }
}

function damagedPng(what) {
    return new Error(`is damaged as a PNG file: ${what}`);
}

function chunksOfPng(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), chunks = new Map();
    for (let at = 8; at + 12 <= bytes.length;) {
        const length = view.getUint32(at), name = String.fromCharCode(...bytes.subarray(at + 4, at + 8));
        if (length > bytes.length - at - 12)
            break;
        if (crcOf(bytes.subarray(at + 4, at + 8 + length)) !== view.getUint32(at + 8 + length))
            throw damagedPng(`the checksum of its chunk ${name.replace(/[^A-Za-z]/g, "?")} is wrong`);
        if (name === "IEND")
            return chunks;
        const list = chunks.get(name) ?? [];
        list.push(bytes.subarray(at + 8, at + 8 + length));
        chunks.set(name, list);
        at += 12 + length;
    }
    throw damagedPng("it ends early");
}

// Functions from 0..1 to light. BT.709: Rec. ITU-R BT.709-6, 1.2 inverted; PQ and HLG: BT.2100-2, tables 4, 5.
const PNG_CURVES = {
    8: (v) => v,
    13: (v) => (v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4)),
    1: (v) => (v < 0.081 ? v / 4.5 : Math.pow((v + 0.099) / 1.099, 1 / 0.45)),
    16: (v) => {
        const p = Math.pow(v, 32 / 2523), top = Math.max(p - 3424 / 4096, 0);
        return 100 * Math.pow(top / (2413 / 128 - (2392 / 128) * p), 16384 / 2610);
    },
    18: (v) => (v <= 0.5 ? (v * v) / 3 : (Math.exp((v - 0.55991073) / 0.17883277) + 0.28466892) / 12),
};
const SDR_CODE_LIGHT = 1 / 255 / 12.92; // drivers/file/common/transfer_curves.h
const BT2020_XY = [0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290];
const P3_XY = [0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290];

function colourOfPng(chunks) {
    const cicp = chunks.get("cICP")?.[0];
    if (cicp?.length === 4) {
        const curve = PNG_CURVES[[6, 14, 15].includes(cicp[1]) ? 1 : cicp[1]];
        if (!curve)
            throw new Error("its cICP transfer is none of 1, 6, 8, 13, 14, 15, 16 and 18");
        return { curve, xy: cicp[0] === 9 ? BT2020_XY : cicp[0] === 12 ? P3_XY : null };
    }
    if (chunks.has("sRGB"))
        return { curve: PNG_CURVES[13], xy: null };
    const number = (name, i) => {
        const c = chunks.get(name)?.[0];
        return c && c.length >= 4 * i + 4 ? new DataView(c.buffer, c.byteOffset).getUint32(4 * i) / 1e5 : null;
    };
    const gamma = number("gAMA", 0), has = number("cHRM", 7) !== null;
    const power = gamma > 0.01 && gamma < 100 ? (Math.abs(gamma - 1) < 1e-4 ? 1 : 1 / gamma) : 0;
    return {
        curve: power === 1 ? PNG_CURVES[8] : power ? (v) => Math.pow(v, power) : PNG_CURVES[13],
        xy: has ? [2, 3, 4, 5, 6, 7, 0, 1].map((i) => number("cHRM", i)) : null,
    };
}

function paeth(a, b, c) {
    const p = a + b - c, pa = Math.abs(p - a), pb = Math.abs(p - b), pc = Math.abs(p - c);
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// Undoes a row's filter (PNG, 9.2) in place.
function unfilter(kind, row, above, step) {
    if (kind > 4)
        throw damagedPng("a row has an unknown filter");
    for (let i = 0; i < row.length; i++) {
        const a = i >= step ? row[i - step] : 0, b = above ? above[i] : 0, c = above && i >= step ? above[i - step] : 0;
        row[i] += [0, a, b, (a + b) >> 1, kind === 4 ? paeth(a, b, c) : 0][kind];
    }
}

// The passes of an interlaced picture (PNG, 8.2): first column, first row, steps.
const ADAM7 = [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

// Calls put(x, y, codes) for each pixel.
function eachPngPixel(data, header, put) {
    const { width, height, bits, channels, interlaced } = header, step = Math.max(1, (bits * channels) >> 3);
    let at = 0;
    for (const [x0, y0, dx, dy] of interlaced ? ADAM7 : [[0, 0, 1, 1]]) {
        const columns = Math.ceil((width - x0) / dx), bytes = Math.ceil((columns * channels * bits) / 8);
        let above = null;
        for (let y = y0; y < height && columns > 0; y += dy) {
            const row = data.subarray(at + 1, at + 1 + bytes);
            if (row.length < bytes)
                throw damagedPng("it has too few rows");
            unfilter(data[at], row, above, step);
            const code = bits === 16 ? (i) => (row[2 * i] << 8) | row[2 * i + 1]
                : bits === 8 ? (i) => row[i]
                : (i) => (row[(i * bits) >> 3] >> (8 - bits - ((i * bits) & 7))) & ((1 << bits) - 1);
            for (let i = 0; i < columns; i++)
                put(x0 + i * dx, y, code, i * channels);
            above = row;
            at += 1 + bytes;
        }
    }
}

function headerOfPng(chunks) {
    const h = chunks.get("IHDR")?.[0];
    if (h?.length !== 13)
        throw damagedPng("it has no header");
    const view = new DataView(h.buffer, h.byteOffset), kind = h[9];
    const header = { width: view.getUint32(0), height: view.getUint32(4), bits: h[8], kind, interlaced: h[12] === 1,
        channels: { 0: 1, 2: 3, 3: 1, 4: 2, 6: 4 }[kind] };
    const allowed = { 0: [1, 2, 4, 8, 16], 2: [8, 16], 3: [1, 2, 4, 8], 4: [8, 16], 6: [8, 16] }[kind];
    if (!allowed?.includes(header.bits) || h[10] || h[11] || h[12] > 1)
        throw damagedPng("its header has values that do not exist");
    checkSize(header.width, header.height);
    return header;
}

async function readPng(bytes) {
    const chunks = chunksOfPng(bytes), header = headerOfPng(chunks), { width, height, bits, kind } = header;
    const data = await inflated(new Blob(chunks.get("IDAT") ?? []));
    if (!data)
        throw damagedPng("its compressed rows cannot be read");
    const colour = colourOfPng(chunks), matrix = matrixToRec709(colour.xy), palette = chunks.get("PLTE")?.[0];
    if (kind === 3 && !palette)
        throw damagedPng("its palette is missing");
    const asIs = bits <= 8 && colour.curve === PNG_CURVES[13] && !matrix, most = kind === 3 ? 255 : (1 << bits) - 1;
    const table = Float32Array.from({ length: most + 1 }, (_, code) => colour.curve(code / most));
    const to = asIs ? new Uint8Array(width * height * 3) : new Float32Array(width * height * 3);
    eachPngPixel(data, header, (x, y, code, first) => {
        const i = 3 * (y * width + x);
        for (let c = 0; c < 3; c++) {
            const v = kind === 3 ? palette[3 * code(first) + c] ?? 0 : code(first + (header.channels > 2 ? c : 0));
            to[i + c] = asIs ? (v * 255) / most : table[v];
        }
    });
    if (asIs)
        return { width, height, pixel: PIXEL.RGB8, data: to };
    convertTo709(to, matrix);
    const isSdr = ![PNG_CURVES[8], PNG_CURVES[16], PNG_CURVES[18]].includes(colour.curve);
    const codeLight = isSdr ? SDR_CODE_LIGHT : colour.curve(1 / ((1 << Math.max(bits, 8)) - 1));
    return { width, height, pixel: PIXEL.RGB32F, data: to, codeLight };
}
