// Decompresses PIZ of OpenEXR: a Huffman code, a wavelet, and a table of the 16-bit words that occur
// ("Technical Introduction to OpenEXR", Data Compression).

// Reads bits, the most significant first.
class PizBits {
    constructor(bytes) {
        this.bytes = bytes;
        this.at = 0;
    }

    bit() {
        const i = this.at++;
        if (i >= 8 * this.bytes.length)
            throw damagedExr("a code runs past the end of the data");
        return (this.bytes[i >> 3] >> (7 - (i & 7))) & 1;
    }

    number(count) {
        let n = 0;
        while (count--)
            n = 2 * n + this.bit();
        return n;
    }
}

// The length of each symbol's code, from `least` to `most`; runs of 0 are packed.
function pizLengths(bits, least, most) {
    const lengths = new Uint8Array(65537);
    for (let i = least; i <= most; i++) {
        const length = bits.number(6), zeros = length === 63 ? bits.number(8) + 6 : length >= 59 ? length - 57 : 0;
        if (i + zeros > most + 1)
            throw damagedExr("its table of codes is too long");
        if (zeros)
            i += zeros - 1;
        else
            lengths[i] = length;
    }
    return lengths;
}

// Canonical codes: for each length the first code, and the symbols in order.
function pizCodes(lengths) {
    const codes = Array.from({ length: 59 }, () => ({ first: 0, symbols: [] }));
    lengths.forEach((length, symbol) => length && codes[length].symbols.push(symbol));
    for (let length = 58, first = 0; length > 0; length--) {
        codes[length].first = first;
        first = Math.floor((first + codes[length].symbols.length) / 2);
    }
    return codes;
}

function pizWords(bytes, count) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), words = new Uint16Array(count);
    if (bytes.length < 20)
        throw damagedExr("its table of codes is missing");
    const least = view.getUint32(0, true), most = view.getUint32(4, true), tableBytes = view.getUint32(8, true);
    if (least > 65536 || most > 65536 || tableBytes > bytes.length - 20)
        throw damagedExr("its table of codes is too long");
    const codes = pizCodes(pizLengths(new PizBits(bytes.subarray(20)), least, most));
    const bits = new PizBits(bytes.subarray(20 + tableBytes));
    for (let done = 0; done < count;) {
        let code = 0, length = 0, symbol;
        do {
            code = 2 * code + bits.bit();
            if (++length > 58)
                throw damagedExr("it has a code without a symbol");
            const of = codes[length];
            symbol = code >= of.first ? of.symbols[code - of.first] : undefined;
        } while (symbol === undefined);
        if (symbol !== most) {
            words[done++] = symbol;
            continue;
        }
        const run = bits.number(8);
        if (!done || done + run > count)
            throw damagedExr("a run does not end where it should");
        words.fill(words[done - 1], done, done + run);
        done += run;
    }
    return words;
}

// Undo one step of the wavelet: a sum and a difference become two samples, of 14 bits, or of 16 with wrap-around.
function unpair14(w, low, high) {
    const difference = (w[high] << 16) >> 16, a = ((w[low] << 16) >> 16) + (difference & 1) + (difference >> 1);
    w[low] = a;
    w[high] = a - difference;
}

function unpair16(w, low, high) {
    const difference = w[high], b = (w[low] - (difference >> 1)) & 0xffff;
    w[low] = difference + b - 0x8000;
    w[high] = b;
}

// Undoes the wavelet of a plane whose samples are stepX and stepY words apart.
function unwavelet(w, start, width, stepX, height, stepY, unpair) {
    let p = 1;
    while (2 * p <= Math.min(width, height))
        p *= 2;
    for (let p2 = p, p1 = p >> 1; p1 >= 1; p2 = p1, p1 >>= 1) {
        const right = stepX * p1, down = stepY * p1;
        let y = 0;
        for (; y + p2 <= height; y += p2) {
            let x = 0;
            for (; x + p2 <= width; x += p2) {
                const at = start + y * stepY + x * stepX;
                unpair(w, at, at + down);
                unpair(w, at + right, at + right + down);
                unpair(w, at, at + right);
                unpair(w, at + down, at + down + right);
            }
            if (width & p1)
                unpair(w, start + y * stepY + x * stepX, start + y * stepY + x * stepX + down);
        }
        if (height & p1)
            for (let x = 0; x + p2 <= width; x += p2)
                unpair(w, start + y * stepY + x * stepX, start + y * stepY + x * stepX + right);
    }
}

// The table from symbols to the words that occur, made from a bitmap, and its highest symbol.
function pizTable(bytes) {
    const table = new Uint16Array(65536), first = bytes[0] | (bytes[1] << 8), last = bytes[2] | (bytes[3] << 8);
    let used = 0;
    if (first > 8191 || last > 8191 || (first <= last && bytes.length < 5 + last - first))
        throw damagedExr("its map of values is too long");
    for (let i = 0; i < 65536; i++) {
        const byte = i >> 3, there = byte >= first && byte <= last && (bytes[4 + byte - first] >> (i & 7)) & 1;
        if (i === 0 || there)
            table[used++] = i;
    }
    return { table, most: used - 1, bytes: 4 + (first <= last ? last - first + 1 : 0) };
}

function unPiz(bytes, block) {
    const { table, most, bytes: mapBytes } = pizTable(bytes), coded = bytes.subarray(mapBytes + 4);
    const words = pizWords(coded, block.bytes / 2), out = new Uint8Array(block.bytes), view = new DataView(out.buffer);
    const starts = [];
    let start = 0;
    for (const c of block.channels) {
        const parts = c.bytes / 2;
        for (let part = 0; part < parts; part++)
            unwavelet(words, start + part, block.width, parts, block.height, parts * block.width,
                most < 1 << 14 ? unpair14 : unpair16);
        starts.push(start);
        start += parts * block.width * block.height;
    }
    for (let y = 0, to = 0; y < block.height; y++)
        block.channels.forEach((c, i) => {
            const count = (c.bytes / 2) * block.width, from = starts[i] + y * count;
            for (let k = 0; k < count; k++, to += 2)
                view.setUint16(to, table[words[from + k]], true);
        });
    return out;
}
