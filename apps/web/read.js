// Chooses a file's reader by its first bytes. Every refusal is a sentence; the caller puts the file's name in front.

const MOST_PIXELS = 2 ** 26;

function checkSize(width, height) {
    if (!(width >= 1 && height >= 1))
        throw new Error(`the header promises ${width} x ${height} pixels; at least 1 x 1 are needed`);
    if (width > 16384 || height > 16384 || width * height > MOST_PIXELS)
        throw new Error(`the header promises ${width} x ${height} pixels; at most 16384 a side and ${MOST_PIXELS} in all ` +
            "are read");
}

// Lets the browser decode the file, to 8-bit codes.
async function readByBrowser(bytes) {
    let bitmap;
    try {
        bitmap = await createImageBitmap(new Blob([bytes]));
    } catch {
        throw new Error("is none of .hdr, .exr, .pfm, .png, and no picture or video that this browser knows");
    }
    checkSize(bitmap.width, bitmap.height);
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    return { width: bitmap.width, height: bitmap.height, pixel: PIXEL.RGBA8, data };
}

// Returns { width, height, pixel, data }, with the data as the core's format `pixel` has them; codeLight: floats that were
// codes, as in drivers/source.h.
async function readPicture(bytes) {
    const begins = (...values) => values.every((v, i) => bytes[i] === v);
    if (begins(0x76, 0x2f, 0x31, 0x01))
        return readExr(bytes);
    if (begins(0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a))
        return readPng(bytes);
    if (begins(0x23, 0x3f))
        return readRadiance(bytes);
    if (begins(0x50, 0x46) || begins(0x50, 0x66))
        return readPfm(bytes);
    return readByBrowser(bytes);
}
