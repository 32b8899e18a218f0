// Converts a file's own primaries and white to Rec.709 and D65, as drivers/file/still/still_colour.c does: matrices in
// doubles, pixels in single precision. Also chooses the unit of light, as apps/frame/any_scale.c does.

const REC709 = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];
const BRADFORD = [0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296]; // ICC.1:2010, annex E

function multiplied(a, b) {
    return Array.from({ length: 9 }, (_, i) => {
        const row = i - i % 3, column = i % 3;
        return a[row] * b[column] + a[row + 1] * b[3 + column] + a[row + 2] * b[6 + column];
    });
}

function times(m, v) {
    return [0, 3, 6].map((r) => m[r] * v[0] + m[r + 1] * v[1] + m[r + 2] * v[2]);
}

function inverted(m) {
    const inverse = new Array(9);
    for (let i = 0; i < 3; i++)
        for (let c = 0; c < 3; c++) {
            const j = (i + 1) % 3, k = (i + 2) % 3, d = (c + 1) % 3, e = (c + 2) % 3;
            inverse[3 * c + i] = m[3 * j + d] * m[3 * k + e] - m[3 * j + e] * m[3 * k + d];
        }
    const determinant = m[0] * inverse[0] + m[1] * inverse[3] + m[2] * inverse[6];
    return Math.abs(determinant) > 1e-3 ? inverse.map((x) => x / determinant) : null;
}

function xyzOf(x, y) {
    return [x / y, 1, (1 - x - y) / y];
}

// null if the chromaticities are not plausible.
function rgbToXyz(xy) {
    if (!xy.every((v) => Math.abs(v) <= 2) || !(xy[6] > 0.05 && xy[7] > 0.05 && xy[6] + xy[7] < 0.95))
        return null;
    const columns = [];
    for (let c = 0; c < 3; c++) {
        columns[c] = xy[2 * c];
        columns[3 + c] = xy[2 * c + 1];
        columns[6 + c] = 1 - xy[2 * c] - xy[2 * c + 1];
    }
    const inverse = inverted(columns), scale = inverse && times(inverse, xyzOf(xy[6], xy[7]));
    return scale && scale.every((s) => s > 0) ? columns.map((v, i) => v * scale[i % 3]) : null;
}

// The matrix to Rec.709, or null if no conversion is needed.
function matrixToRec709(xy) {
    const from = xy && rgbToXyz(xy);
    if (!from)
        return null;
    const cones = [times(BRADFORD, xyzOf(xy[6], xy[7])), times(BRADFORD, xyzOf(REC709[6], REC709[7]))];
    const scaled = BRADFORD.map((v, i) => v * cones[1][(i - i % 3) / 3] / cones[0][(i - i % 3) / 3]);
    const adapt = multiplied(inverted(BRADFORD), scaled);
    const matrix = multiplied(inverted(rgbToXyz(REC709)), multiplied(adapt, from));
    return matrix.some((v, i) => Math.abs(v - (i % 4 === 0 ? 1 : 0)) > 4e-3) ? matrix.map(Math.fround) : null;
}

// The same of an OpenEXR file, as drivers/file/still/read_exr.c: the axes of XYZ as primaries are CIE XYZ under D65.
function matrixOfExr(xy) {
    const areAxes = xy?.every((v, i) => Math.abs(v - [1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3][i]) < 1e-3);
    return areAxes ? inverted(rgbToXyz(REC709)).map(Math.fround) : matrixToRec709(xy);
}

function convertTo709(rgb, matrix) {
    const f = Math.fround, m = matrix;
    for (let i = 0; m && i < rgb.length; i += 3) {
        const r = rgb[i], g = rgb[i + 1], b = rgb[i + 2];
        for (let c = 0; c < 3; c++)
            rgb[i + c] = f(f(f(m[3 * c] * r) + f(m[3 * c + 1] * g)) + f(m[3 * c + 2] * b));
    }
}

// The power of two by which light far from 1 is multiplied. It depends on the value that the brightest channel exceeds
// in 5 % of up to 256 x 256 pixels with light: from 2^-6 to 2^16 nothing is changed, else that value becomes 2^4.
function stopsForUnit(rgb, width, height) {
    const stops = [], stepX = Math.ceil(width / 256), stepY = Math.ceil(height / 256);
    const exponent = new DataView(new ArrayBuffer(4));
    for (let y = 0; y < height; y += stepY)
        for (let x = 0; x < width; x += stepX) {
            const i = 3 * (y * width + x), most = Math.max(rgb[i], rgb[i + 1], rgb[i + 2]);
            if (!(most > 0 && Number.isFinite(rgb[i] + rgb[i + 1] + rgb[i + 2])))
                continue;
            exponent.setFloat32(0, most);
            stops.push((exponent.getUint32(0) >>> 23) - 127);
        }
    stops.sort((a, b) => a - b);
    const bright = stops[Math.max(0, Math.ceil(0.95 * stops.length) - 1)] ?? 0;
    return bright >= -6 && bright <= 16 ? 0 : Math.max(-60, Math.min(60, 4 - bright));
}
