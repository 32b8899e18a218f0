// The one file that calls libcamera: layer.h's table over its C++. About twenty calls; compiled against 0.0.3 and
// newer. Controls of 0.5 and later are looked up by name in what the camera lists, so that no newer header is needed.
#include "layer.h"

#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <errno.h>
#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/control_ids.h>
#include <libcamera/formats.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/logging.h>
#include <libcamera/property_ids.h>

extern "C" {
#include "v4l2/format.h"
}

namespace lc = libcamera;

namespace
{

// ---- names of formats ----

constexpr uint32_t four(char a, char b, char c, char d)
{
    return v4l2_fourcc(a, b, c, d);
}

struct Format {
    lc::PixelFormat pixel;
    uint32_t fourcc; // V4L2's, as format.c reads it
};

// DRM's names (libcamera/formats.h) and V4L2's. DRM's RGB888 is B, G, R in memory.
const Format formats[] = {
    {lc::formats::SRGGB8, V4L2_PIX_FMT_SRGGB8},
    {lc::formats::SGRBG8, V4L2_PIX_FMT_SGRBG8},
    {lc::formats::SGBRG8, V4L2_PIX_FMT_SGBRG8},
    {lc::formats::SBGGR8, V4L2_PIX_FMT_SBGGR8},
    {lc::formats::SRGGB10, V4L2_PIX_FMT_SRGGB10},
    {lc::formats::SGRBG10, V4L2_PIX_FMT_SGRBG10},
    {lc::formats::SGBRG10, V4L2_PIX_FMT_SGBRG10},
    {lc::formats::SBGGR10, V4L2_PIX_FMT_SBGGR10},
    {lc::formats::SRGGB12, V4L2_PIX_FMT_SRGGB12},
    {lc::formats::SGRBG12, V4L2_PIX_FMT_SGRBG12},
    {lc::formats::SGBRG12, V4L2_PIX_FMT_SGBRG12},
    {lc::formats::SBGGR12, V4L2_PIX_FMT_SBGGR12},
    {lc::formats::SRGGB16, V4L2_PIX_FMT_SRGGB16},
    {lc::formats::SGRBG16, V4L2_PIX_FMT_SGRBG16},
    {lc::formats::SGBRG16, V4L2_PIX_FMT_SGBRG16},
    {lc::formats::SBGGR16, V4L2_PIX_FMT_SBGGR16},
    {lc::formats::SRGGB10_CSI2P, V4L2_PIX_FMT_SRGGB10P},
    {lc::formats::SGRBG10_CSI2P, V4L2_PIX_FMT_SGRBG10P},
    {lc::formats::SGBRG10_CSI2P, V4L2_PIX_FMT_SGBRG10P},
    {lc::formats::SBGGR10_CSI2P, V4L2_PIX_FMT_SBGGR10P},
    {lc::formats::SRGGB12_CSI2P, four('p', 'R', 'C', 'C')},
    {lc::formats::SGRBG12_CSI2P, four('p', 'g', 'C', 'C')},
    {lc::formats::SGBRG12_CSI2P, four('p', 'G', 'C', 'C')},
    {lc::formats::SBGGR12_CSI2P, four('p', 'B', 'C', 'C')},
    {lc::formats::R8, V4L2_PIX_FMT_GREY},
    {lc::formats::R10, V4L2_PIX_FMT_Y10},
    {lc::formats::R12, V4L2_PIX_FMT_Y12},
    {lc::formats::R10_CSI2P, four('Y', '1', '0', 'P')},
    {lc::formats::YUYV, V4L2_PIX_FMT_YUYV},
    {lc::formats::UYVY, V4L2_PIX_FMT_UYVY},
    {lc::formats::NV12, V4L2_PIX_FMT_NV12},
    {lc::formats::NV21, V4L2_PIX_FMT_NV21},
    {lc::formats::NV16, V4L2_PIX_FMT_NV16},
    {lc::formats::YUV420, V4L2_PIX_FMT_YUV420},
    {lc::formats::YVU420, V4L2_PIX_FMT_YVU420},
    {lc::formats::BGR888, V4L2_PIX_FMT_RGB24},
    {lc::formats::RGB888, V4L2_PIX_FMT_BGR24},
    {lc::formats::XRGB8888, V4L2_PIX_FMT_XBGR32},
    {lc::formats::ARGB8888, V4L2_PIX_FMT_ABGR32},
    {lc::formats::XBGR8888, four('X', 'B', '2', '4')},
    {lc::formats::ABGR8888, four('A', 'B', '2', '4')},
};

uint32_t fourcc_of(const lc::PixelFormat &pixel)
{
    for (const Format &f : formats)
        if (f.pixel == pixel)
            return f.fourcc;
    return 0;
}

bool is_read(const lc::PixelFormat &pixel)
{
    return fourcc_of(pixel) && pupil_v4l2_is_read(fourcc_of(pixel));
}

bool is_raw(const lc::PixelFormat &pixel)
{
    return is_read(pixel) && pupil_pixel_is_mosaic(pupil_v4l2_pixel_of(fourcc_of(pixel)));
}

// ---- controls ----

double number_of(const lc::ControlValue &value)
{
    const void *data = value.isNone() ? nullptr : value.data().data();
    if (!data || !value.numElements())
        return 0.0;
    switch (value.type()) { // of an array the first one
    case lc::ControlTypeBool:
        return *static_cast<const bool *>(data);
    case lc::ControlTypeByte:
        return *static_cast<const uint8_t *>(data);
    case lc::ControlTypeInteger32: {
        int32_t n;
        std::memcpy(&n, data, sizeof n);
        return n;
    }
    case lc::ControlTypeInteger64: {
        int64_t n;
        std::memcpy(&n, data, sizeof n);
        return static_cast<double>(n);
    }
    case lc::ControlTypeFloat: {
        float x;
        std::memcpy(&x, data, sizeof x);
        return static_cast<double>(x);
    }
    default:
        return 0.0;
    }
}

pupil_libcamera_range range_of(const lc::ControlInfo &info, double unit)
{
    return {number_of(info.min()) * unit, number_of(info.max()) * unit, number_of(info.def()) * unit};
}

// ---- the camera ----

// One for the process, as libcamera demands, as long as it is needed.
std::shared_ptr<lc::CameraManager> manager(pupil_why *why)
{
    static std::mutex lock;
    static std::weak_ptr<lc::CameraManager> only;
    const std::lock_guard<std::mutex> guard(lock);
    std::shared_ptr<lc::CameraManager> m = only.lock();
    if (m)
        return m;
    if (!std::getenv("LIBCAMERA_LOG_LEVELS")) // failures are reported as sentences
        lc::logSetTarget(lc::LoggingTargetNone);
    m = std::shared_ptr<lc::CameraManager>(new lc::CameraManager, [](lc::CameraManager *gone) {
        gone->stop();
        delete gone;
    });
    const int error = m->start();
    if (error) {
        std::snprintf(why->text, sizeof why->text, "libcamera does not start: %s", std::strerror(-error));
        return nullptr;
    }
    only = m;
    return m;
}

int fail(pupil_why *why, const std::string &id, const char *what, int error)
{
    std::snprintf(why->text, sizeof why->text, "libcamera:%.255s: %s: %s", id.c_str(), what, std::strerror(error));
    return -1;
}

class Device
{
  public:
    Device(std::shared_ptr<lc::CameraManager> m, std::shared_ptr<lc::Camera> c)
        : manager_(std::move(m)), camera_(std::move(c))
    {
        for (const auto &[id, info] : camera_->controls())
            if (id->name() == "ExposureTimeMode")
                exposure_mode_ = id->id();
            else if (id->name() == "AnalogueGainMode")
                gain_mode_ = id->id();
    }

    ~Device();

    int offers(pupil_live_offers *offers, pupil_libcamera_can *can) const;
    int configure(const pupil_libcamera_wanted *wanted, pupil_libcamera_stream *stream, pupil_why *why);
    int start(pupil_why *why);
    void stop();
    int queue(uint32_t index, const pupil_libcamera_ask *ask);
    int wait(pupil_libcamera_done *done, int timeout_ms);

    std::vector<pupil_libcamera_buffer> buffers;

  private:
    int add_modes(pupil_live_modes *modes, lc::StreamRole role) const;
    bool choose(lc::StreamRole role, const pupil_libcamera_wanted *wanted);
    int map(pupil_why *why);
    void completed(lc::Request *request);
    void disconnected();
    void sync(uint32_t index, uint64_t flags);

    std::shared_ptr<lc::CameraManager> manager_;
    std::shared_ptr<lc::Camera> camera_;
    std::unique_ptr<lc::CameraConfiguration> config_;
    std::unique_ptr<lc::FrameBufferAllocator> allocator_;
    std::vector<std::unique_ptr<lc::Request>> requests_;
    std::vector<std::pair<void *, size_t>> maps_;
    bool acquired_ = false;
    unsigned exposure_mode_ = 0, gain_mode_ = 0; // ids; 0: not listed
    std::mutex lock_;                            // of what follows
    std::condition_variable came_;
    std::deque<pupil_libcamera_done> done_;
    bool running_ = false, gone_ = false;
};

Device::~Device()
{
    stop();
    for (const auto &[memory, bytes] : maps_)
        munmap(memory, bytes);
    requests_.clear();
    allocator_.reset();
    if (acquired_) {
        camera_->requestCompleted.disconnect(this);
        camera_->disconnected.disconnect(this);
        camera_->release();
    }
    config_.reset();
    camera_.reset(); // before the manager
}

// ---- what it offers ----

int Device::add_modes(pupil_live_modes *modes, lc::StreamRole role) const
{
    const std::unique_ptr<lc::CameraConfiguration> config = camera_->generateConfiguration({role});
    if (!config || config->empty())
        return 0;
    const lc::StreamFormats &of = config->at(0).formats();
    for (const lc::PixelFormat &pixel : of.pixelformats()) {
        const std::string name = pixel.toString();
        bool known = false;
        for (uint32_t i = 0; i < modes->count; i++)
            known = known || name == modes->mode[i].description;
        pupil_live_mode *mode = known ? nullptr : pupil_live_modes_add(modes);
        if (known)
            continue;
        if (!mode)
            return -1;
        mode->fourcc = fourcc_of(pixel);
        mode->read = is_read(pixel);
        std::snprintf(mode->name, sizeof mode->name, "%.11s",
                      mode->fourcc ? pupil_v4l2_fourcc_name(mode->fourcc).text : name.c_str());
        std::snprintf(mode->description, sizeof mode->description, "%.31s", name.c_str());
        for (const lc::Size &size : of.sizes(pixel)) {
            pupil_live_size *to = pupil_live_mode_add_size(mode);
            if (!to)
                return -1;
            to->width = to->max_width = size.width;
            to->height = to->max_height = size.height;
        }
    }
    return 0;
}

int Device::offers(pupil_live_offers *offers, pupil_libcamera_can *can) const
{
    const auto model = camera_->properties().get(lc::properties::Model);
    pupil_libcamera_can all = {};
    std::snprintf(all.model, sizeof all.model, "%.63s", model ? std::string(*model).c_str() : "camera");
    for (const auto &[id, info] : camera_->controls()) {
        const unsigned n = id->id();
        if (n == lc::controls::ExposureTime.id()) {
            all.controls |= PUPIL_LIBCAMERA_CAN_EXPOSURE;
            all.exposure_s = range_of(info, 1e-6);
        } else if (n == lc::controls::AnalogueGain.id()) {
            all.controls |= PUPIL_LIBCAMERA_CAN_GAIN;
            all.gain = range_of(info, 1.0);
        } else if (n == lc::controls::FrameDurationLimits.id()) {
            all.controls |= PUPIL_LIBCAMERA_CAN_FRAME;
            all.frame_s = range_of(info, 1e-6);
        } else if (n == lc::controls::AeEnable.id()) {
            all.controls |= PUPIL_LIBCAMERA_CAN_AE;
        }
        if (!offers || offers->controls == PUPIL_LIVE_CONTROLS)
            continue;
        pupil_live_control *c = &offers->control[offers->controls++];
        c->id = n;
        std::snprintf(c->name, sizeof c->name, "%.31s", id->name().c_str());
        c->least = number_of(info.min());
        c->most = number_of(info.max());
        c->usual = number_of(info.def());
        c->value = static_cast<double>(NAN); // libcamera does not report its present value
        c->automatic = n == lc::controls::AeEnable.id() && c->usual > 0.0;
        if (n == lc::controls::AnalogueGain.id())
            offers->gain_place = offers->controls;
    }
    all.controls |= exposure_mode_ ? PUPIL_LIBCAMERA_CAN_EXPOSURE_MODE : 0;
    all.controls |= gain_mode_ ? PUPIL_LIBCAMERA_CAN_GAIN_MODE : 0;
    if (can)
        *can = all;
    if (!offers)
        return 0;
    std::snprintf(offers->is.name, sizeof offers->is.name, "%s", all.model);
    return add_modes(&offers->modes, lc::StreamRole::Raw) || add_modes(&offers->modes, lc::StreamRole::VideoRecording)
               ? -1
               : 0;
}

// ---- the stream ----

// Into config_; false: this role has nothing that is wanted.
bool Device::choose(lc::StreamRole role, const pupil_libcamera_wanted *wanted)
{
    config_ = camera_->generateConfiguration({role});
    if (!config_ || config_->empty())
        return false;
    lc::StreamConfiguration &stream = config_->at(0);
    std::vector<lc::PixelFormat> pixels = stream.formats().pixelformats();
    pixels.insert(pixels.begin(), stream.pixelFormat); // the camera's own choice first
    lc::PixelFormat chosen;
    for (const lc::PixelFormat &pixel : pixels) {
        const bool fits = wanted->fourcc ? fourcc_of(pixel) == wanted->fourcc
                                         : is_read(pixel) && (role != lc::StreamRole::Raw || is_raw(pixel));
        if (fits && !chosen.isValid())
            chosen = pixel;
    }
    if (!chosen.isValid())
        return false;
    stream.pixelFormat = chosen;
    stream.bufferCount = wanted->buffers;
    if (wanted->width)
        stream.size.width = wanted->width;
    if (wanted->height)
        stream.size.height = wanted->height;
    return config_->validate() != lc::CameraConfiguration::Invalid && config_->at(0).pixelFormat == chosen;
}

void take_colour(const lc::StreamConfiguration &from, pupil_libcamera_stream *to)
{
    if (!from.colorSpace)
        return;
    const lc::ColorSpace &c = *from.colorSpace;
    using P = lc::ColorSpace::Primaries;
    using T = lc::ColorSpace::TransferFunction;
    using E = lc::ColorSpace::YcbcrEncoding;
    const bool is_srgb = c.transferFunction == T::Srgb;
    to->colorspace = c.primaries == P::Raw         ? V4L2_COLORSPACE_RAW
                     : c.primaries == P::Smpte170m ? V4L2_COLORSPACE_SMPTE170M
                     : c.primaries == P::Rec2020   ? V4L2_COLORSPACE_BT2020
                     : is_srgb                     ? V4L2_COLORSPACE_SRGB
                                                   : V4L2_COLORSPACE_REC709;
    to->xfer_func = c.transferFunction == T::Linear ? V4L2_XFER_FUNC_NONE
                    : is_srgb                       ? V4L2_XFER_FUNC_SRGB
                                                    : V4L2_XFER_FUNC_709;
    to->ycbcr_enc = c.ycbcrEncoding == E::Rec709    ? V4L2_YCBCR_ENC_709
                    : c.ycbcrEncoding == E::Rec2020 ? V4L2_YCBCR_ENC_BT2020
                    : c.ycbcrEncoding == E::Rec601  ? V4L2_YCBCR_ENC_601
                                                    : V4L2_YCBCR_ENC_DEFAULT;
    to->quantization =
        c.range == lc::ColorSpace::Range::Full ? V4L2_QUANTIZATION_FULL_RANGE : V4L2_QUANTIZATION_LIM_RANGE;
}

int Device::map(pupil_why *why)
{
    for (const std::unique_ptr<lc::FrameBuffer> &from : allocator_->buffers(config_->at(0).stream())) {
        pupil_libcamera_buffer to = {};
        std::map<int, void *> mapped; // planes may be in one dma-buf
        for (const lc::FrameBuffer::Plane &plane : from->planes()) {
            const int fd = plane.fd.get();
            if (to.planes == PUPIL_LIBCAMERA_MOST_PLANES)
                break;
            if (!mapped.count(fd)) {
                const off_t bytes = lseek(fd, 0, SEEK_END);
                void *memory =
                    bytes > 0 ? mmap(nullptr, static_cast<size_t>(bytes), PROT_READ, MAP_SHARED, fd, 0) : MAP_FAILED;
                if (memory == MAP_FAILED)
                    return fail(why, camera_->id(), "its buffers cannot be mapped", errno);
                maps_.emplace_back(memory, static_cast<size_t>(bytes));
                mapped[fd] = memory;
            }
            to.memory[to.planes] = static_cast<const unsigned char *>(mapped[fd]) + plane.offset;
            to.bytes[to.planes] = plane.length;
            to.dmabuf[to.planes] = fd;
            to.offset_bytes[to.planes++] = plane.offset;
        }
        buffers.push_back(to);
    }
    return 0;
}

int Device::configure(const pupil_libcamera_wanted *wanted, pupil_libcamera_stream *stream, pupil_why *why)
{
    const std::string id = camera_->id();
    const int busy = camera_->acquire();
    if (busy)
        return fail(why, id, busy == -EBUSY ? "another program has it" : "it cannot be had", -busy);
    acquired_ = true;
    camera_->requestCompleted.connect(this, &Device::completed);
    camera_->disconnected.connect(this, &Device::disconnected);
    if (!choose(lc::StreamRole::Raw, wanted) && !choose(lc::StreamRole::VideoRecording, wanted) &&
        !choose(lc::StreamRole::Viewfinder, wanted)) {
        std::snprintf(why->text, sizeof why->text,
                      "libcamera:%.255s: has no format %s that is read; 'pupil list' shows what it has", id.c_str(),
                      wanted->fourcc ? pupil_v4l2_fourcc_name(wanted->fourcc).text : "at all");
        return -1;
    }
    int error = camera_->configure(config_.get());
    if (error)
        return fail(why, id, "its stream cannot be set up", -error);
    const lc::StreamConfiguration &from = config_->at(0);
    allocator_ = std::make_unique<lc::FrameBufferAllocator>(camera_);
    error = allocator_->allocate(from.stream());
    if (error < 0)
        return fail(why, id, "there is no memory for its frames", -error);
    if (map(why))
        return -1;
    const auto &frames = allocator_->buffers(from.stream());
    for (size_t i = 0; i < frames.size() && i < PUPIL_LIBCAMERA_MOST_BUFFERS; i++) {
        std::unique_ptr<lc::Request> request = camera_->createRequest(i);
        if (!request || request->addBuffer(from.stream(), frames[i].get()))
            return fail(why, id, "its requests cannot be made", ENOMEM);
        requests_.push_back(std::move(request));
    }
    if (requests_.empty())
        return fail(why, id, "it has no memory for frames", ENOMEM);
    *stream = {};
    stream->fourcc = fourcc_of(from.pixelFormat);
    stream->width = from.size.width;
    stream->height = from.size.height;
    stream->stride_bytes = from.stride;
    stream->size_bytes = from.frameSize;
    stream->buffers = static_cast<uint32_t>(requests_.size());
    take_colour(from, stream);
    return 0;
}

int Device::start(pupil_why *why)
{
    {
        const std::lock_guard<std::mutex> guard(lock_);
        running_ = true;
        done_.clear();
    }
    const int error = camera_->start();
    return error ? fail(why, camera_->id(), "its stream does not start", -error) : 0;
}

void Device::stop()
{
    {
        const std::lock_guard<std::mutex> guard(lock_);
        running_ = false;
        done_.clear();
    }
    if (acquired_)
        camera_->stop();
}

// Before the CPU reads a dma-buf that a device has written, and after it. Memory that does not need it returns an
// error.
void Device::sync(uint32_t index, uint64_t flags)
{
    const pupil_libcamera_buffer &b = buffers[index];
    for (uint32_t i = 0; i < b.planes; i++) {
        dma_buf_sync s = {flags | DMA_BUF_SYNC_READ};
        if (!i || b.dmabuf[i] != b.dmabuf[i - 1])
            (void)ioctl(b.dmabuf[i], DMA_BUF_IOCTL_SYNC, &s);
    }
}

int Device::queue(uint32_t index, const pupil_libcamera_ask *ask)
{
    lc::Request *request = requests_[index].get();
    if (request->status() == lc::Request::RequestComplete)
        sync(index, DMA_BUF_SYNC_END);
    request->reuse(lc::Request::ReuseBuffers);
    lc::ControlList &controls = request->controls();
    if (ask->automatic) {
        const bool on = ask->automatic > 0;
        if (camera_->controls().count(lc::controls::AeEnable.id()))
            controls.set(lc::controls::AeEnable, on);
        if (exposure_mode_) // 0: auto, 1: manual, of both
            controls.set(exposure_mode_, lc::ControlValue(static_cast<int32_t>(!on)));
        if (gain_mode_)
            controls.set(gain_mode_, lc::ControlValue(static_cast<int32_t>(!on)));
    }
    if (ask->exposure_s > 0.0)
        controls.set(lc::controls::ExposureTime, static_cast<int32_t>(ask->exposure_s * 1e6 + 0.5));
    if (ask->gain > 0.0)
        controls.set(lc::controls::AnalogueGain, static_cast<float>(ask->gain));
    if (ask->frame_most_s > 0.0) {
        const int64_t limits[2] = {static_cast<int64_t>(ask->frame_least_s * 1e6 + 0.5),
                                   static_cast<int64_t>(ask->frame_most_s * 1e6 + 0.5)};
        controls.set(lc::controls::FrameDurationLimits, lc::Span<const int64_t, 2>(limits));
    }
    return camera_->queueRequest(request) ? -1 : 0;
}

// ---- in libcamera's thread ----

void Device::completed(lc::Request *request)
{
    pupil_libcamera_done d = {};
    const lc::ControlList &told = request->metadata();
    const lc::FrameBuffer *buffer = request->buffers().begin()->second;
    const lc::FrameMetadata &frame = buffer->metadata();
    d.index = static_cast<uint32_t>(request->cookie());
    d.cancelled =
        request->status() != lc::Request::RequestComplete || frame.status == lc::FrameMetadata::FrameCancelled;
    d.damaged = frame.status == lc::FrameMetadata::FrameError;
    d.sequence = frame.sequence;
    d.stamp_ns = static_cast<int64_t>(frame.timestamp);
    d.black = -1.0;
    for (size_t i = 0; i < frame.planes().size() && i < PUPIL_LIBCAMERA_MOST_PLANES; i++)
        d.used[i] = frame.planes()[i].bytesused;
    if (const auto exposure = told.get(lc::controls::ExposureTime))
        d.exposure_s = *exposure * 1e-6;
    if (const auto gain = told.get(lc::controls::AnalogueGain))
        d.gain = static_cast<double>(*gain);
    if (const auto black = told.get(lc::controls::SensorBlackLevels)) // of R, Gr, Gb, B, in 16 bits
        d.black = ((*black)[0] + (*black)[1] + (*black)[2] + (*black)[3]) / 4.0;
    const std::lock_guard<std::mutex> guard(lock_);
    if (!running_)
        return;
    done_.push_back(d);
    came_.notify_one();
}

void Device::disconnected()
{
    const std::lock_guard<std::mutex> guard(lock_);
    gone_ = true;
    came_.notify_one();
}

int Device::wait(pupil_libcamera_done *done, int timeout_ms)
{
    std::unique_lock<std::mutex> guard(lock_);
    came_.wait_for(guard, std::chrono::milliseconds(timeout_ms), [this] { return gone_ || !done_.empty(); });
    if (gone_)
        return -1;
    if (done_.empty())
        return 0;
    *done = done_.front();
    done_.pop_front();
    guard.unlock();
    if (!done->cancelled)
        sync(done->index, DMA_BUF_SYNC_START);
    return 1;
}

// ---- the table ----

int list_cameras(void *, void (*found)(void *, const char *, const char *), void *closure, pupil_why *why)
{
    const std::shared_ptr<lc::CameraManager> m = manager(why);
    if (!m)
        return -1;
    for (const std::shared_ptr<lc::Camera> &camera : m->cameras()) {
        const auto model = camera->properties().get(lc::properties::Model);
        found(closure, camera->id().c_str(), model ? std::string(*model).c_str() : "camera");
    }
    return 0;
}

void *open_camera(void *, const char *id, pupil_why *why)
{
    const std::shared_ptr<lc::CameraManager> m = manager(why);
    const std::shared_ptr<lc::Camera> camera = m ? m->get(std::string(id)) : nullptr;
    if (m && !camera)
        std::snprintf(why->text, sizeof why->text, "libcamera:%.255s: there is no such camera", id);
    return camera ? new Device(m, camera) : nullptr;
}

Device *of(void *camera)
{
    return static_cast<Device *>(camera);
}

int64_t now_ns(void *)
{
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<int64_t>(t.tv_sec) * 1000000000 + t.tv_nsec;
}

const pupil_libcamera_layer layer = {
    nullptr,
    list_cameras,
    open_camera,
    [](void *camera) { delete of(camera); },
    [](void *camera, pupil_live_offers *offers, pupil_libcamera_can *can) { return of(camera)->offers(offers, can); },
    [](void *camera, const pupil_libcamera_wanted *wanted, pupil_libcamera_stream *stream, pupil_why *why) {
        return of(camera)->configure(wanted, stream, why);
    },
    [](void *camera, uint32_t index) -> const pupil_libcamera_buffer * { return &of(camera)->buffers[index]; },
    [](void *camera, pupil_why *why) { return of(camera)->start(why); },
    [](void *camera) { of(camera)->stop(); },
    [](void *camera, uint32_t index, const pupil_libcamera_ask *ask) { return of(camera)->queue(index, ask); },
    [](void *camera, pupil_libcamera_done *done, int timeout_ms) { return of(camera)->wait(done, timeout_ms); },
    now_ns,
};

} // namespace

extern "C" const pupil_libcamera_layer *pupil_libcamera_library(void)
{
    return &layer;
}

extern "C" const char *pupil_libcamera_version(void)
{
    return lc::CameraManager::version().c_str();
}
