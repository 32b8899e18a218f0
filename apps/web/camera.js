// Frames of the browser's camera or of a video file: the original planes if the browser has them (VideoFrame), else
// 8-bit RGB from a canvas.

const MATRIX_BY_NAME = { smpte170m: MATRIX.BT601, bt470bg: MATRIX.BT601, bt709: MATRIX.BT709, "bt2020-ncl": MATRIX.BT2020 };

// Releases the file or the camera of a video element.
function release(video) {
    video.onerror = null;
    video.srcObject?.getTracks().forEach((track) => track.stop());
    video.srcObject = null;
    if (video.src)
        URL.revokeObjectURL(video.src);
    video.removeAttribute("src");
    video.load();
}

class VideoFrames {
    constructor(video) {
        this.video = video;
        this.canvas = null;
        this.planes = typeof VideoFrame === "function";
        this.running = false;
    }

    // Calls take(read, timestampNs) for each frame; read(core) allocates and fills the core's frame, and returns its
    // coding. first: the metadata of a frame that has already arrived.
    start(take, fail, first) {
        this.running = true;
        const next = async (now, metadata) => {
            if (!this.running)
                return;
            try {
                await this.frame(take, metadata);
            } catch (error) {
                fail(error);
            }
            if (this.running)
                this.video.requestVideoFrameCallback(next);
        };
        if (first)
            next(0, first);
        else
            this.video.requestVideoFrameCallback(next);
    }

    stop() {
        this.running = false;
        release(this.video);
    }

    async frame(take, metadata) {
        const frame = this.planes ? new VideoFrame(this.video) : null;
        const timestampNs = BigInt(Math.round((frame ? frame.timestamp : metadata.mediaTime * 1e6))) * 1000n;
        try {
            const pixel = { I420: PIXEL.I420, NV12: PIXEL.NV12 }[frame?.format];
            await take((core) => (pixel ? this.readPlanes(core, frame, pixel) : this.readCanvas(core)), timestampNs);
        } finally {
            frame?.close();
        }
    }

    async readPlanes(core, frame, pixel) {
        const { width, height } = frame.visibleRect;
        if (core.pixel !== pixel || core.width !== width || core.height !== height)
            core.make(pixel, width, height);
        if (frame.allocationSize() !== core.frameBytes)
            return this.readCanvas(core);
        await frame.copyTo(core.bytes(core.frameAt, core.frameBytes));
        const { matrix, fullRange } = frame.colorSpace;
        return { matrix: MATRIX_BY_NAME[matrix] ?? MATRIX.BT601, range: fullRange ? RANGE.FULL : RANGE.LIMITED };
    }

    async readCanvas(core) {
        const width = this.video.videoWidth, height = this.video.videoHeight;
        this.canvas ??= new OffscreenCanvas(width, height);
        Object.assign(this.canvas, { width, height });
        const context = this.canvas.getContext("2d", { willReadFrequently: true });
        context.drawImage(this.video, 0, 0);
        if (core.pixel !== PIXEL.RGBA8 || core.width !== width || core.height !== height)
            core.make(PIXEL.RGBA8, width, height);
        core.bytes(core.frameAt, core.frameBytes).set(context.getImageData(0, 0, width, height).data);
        return { matrix: MATRIX.BT601, range: RANGE.FULL };
    }
}

// The exposure of a camera's track, with the constraints that a page can set: exposureMode, exposureTime (100 us), iso.
class Exposure {
    constructor(track) {
        this.track = track;
        this.can = track.getCapabilities?.() ?? {};
        this.pending = false;
        this.writes = 0;
        this.refused = "";
    }

    get possible() {
        return Boolean(this.can.exposureMode?.includes("manual") && this.can.exposureTime?.max > 0);
    }

    get why() {
        return this.possible ? "" : "This camera, or this browser, does not let a page set the exposure time.";
    }

    get now() {
        const s = this.track.getSettings();
        return { exposureS: (s.exposureTime ?? 0) * 1e-4, gain: this.can.iso && s.iso ? s.iso / this.can.iso.min : 1 };
    }

    // Least, most and step of the exposure time in seconds, and the largest gain.
    get limits() {
        const { min, max, step } = this.can.exposureTime, iso = this.can.iso;
        const tick = Math.max(step || 1, 1e-4) * 1e-4, least = Math.max(min * 1e-4, tick);
        return { least, most: Math.max(max * 1e-4, least), step: tick, gain: iso?.min > 0 ? iso.max / iso.min : 1 };
    }

    // One request at a time: a request made meanwhile is dropped, and the loop asks again.
    async ask(exposureS, gain) {
        if (this.pending)
            return false;
        this.pending = true;
        const wanted = { exposureMode: "manual", exposureTime: exposureS * 1e4 };
        if (this.can.iso?.min > 0)
            wanted.iso = gain * this.can.iso.min;
        try {
            await this.track.applyConstraints({ advanced: [wanted] });
            this.writes++;
            this.refused = "";
        } catch (error) {
            this.refused = error.message;
        } finally {
            this.pending = false;
        }
        return true;
    }

    async giveBack() {
        if (this.can.exposureMode?.includes("continuous"))
            await this.track.applyConstraints({ advanced: [{ exposureMode: "continuous" }] }).catch(() => {});
    }
}
