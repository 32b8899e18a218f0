// libcamera_frames.h: plain libcamera, without pupil: YUYV frames of the first camera, request by request.
// completed() gets each request with a frame, in libcamera's thread; it may set controls for the next request.
#ifndef LIBCAMERA_FRAMES_H
#define LIBCAMERA_FRAMES_H

#include <atomic>
#include <cstdio>
#include <functional>
#include <libcamera/libcamera.h>
#include <pupil/image.h>
#include <sys/mman.h>
#include <unistd.h>

class Frames
{
  public:
    std::function<void(libcamera::Request *, const pupil_image_const &image, libcamera::ControlList *next)> completed;
    libcamera::CameraManager manager;
    std::shared_ptr<libcamera::Camera> camera;
    libcamera::StreamConfiguration stream;

    bool open(unsigned width, unsigned height)
    {
        const bool opened = set_up(width, height);
        if (!opened)
            fputs("libcamera has no camera with YUYV\n", stderr);
        return opened;
    }

    bool set_up(unsigned width, unsigned height)
    {
        if (manager.start() || manager.cameras().empty())
            return false;
        camera = manager.cameras()[0];
        config_ = camera->acquire() ? nullptr : camera->generateConfiguration({libcamera::StreamRole::VideoRecording});
        if (!config_ || config_->empty())
            return false;
        config_->at(0).pixelFormat = libcamera::formats::YUYV;
        config_->at(0).size = {width, height};
        if (config_->validate() == libcamera::CameraConfiguration::Invalid || camera->configure(config_.get()))
            return false;
        stream = config_->at(0);
        allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera);
        return stream.pixelFormat == libcamera::formats::YUYV && allocator_->allocate(stream.stream()) > 0;
    }

    void run(unsigned seconds)
    {
        for (const auto &buffer : allocator_->buffers(stream.stream())) {
            const auto &plane = buffer->planes()[0];
            memory_.push_back(mmap(nullptr, plane.length, PROT_READ, MAP_SHARED, plane.fd.get(), plane.offset));
            requests_.push_back(camera->createRequest(memory_.size() - 1));
            requests_.back()->addBuffer(stream.stream(), buffer.get());
        }
        requests_[0]->controls().merge(first); // alone: until then webcams refuse an exposure time
        camera->requestCompleted.connect(this, &Frames::done);
        camera->start();
        for (const auto &request : requests_)
            camera->queueRequest(request.get());
        sleep(seconds);
        running_ = false;
        camera->stop();
        requests_.clear();
        allocator_.reset();
        camera->release();
        camera.reset();
        manager.stop();
    }

    libcamera::ControlList first{libcamera::controls::controls};

  private:
    pupil_image_const image(const void *data) const
    {
        pupil_image_const i = {};
        i.size_bytes = sizeof i;
        i.pixel = PUPIL_PIXEL_YUYV;
        i.data = data;
        i.stride_bytes = stream.stride;
        i.width = stream.size.width;
        i.height = stream.size.height;
        return i;
    }

    void done(libcamera::Request *request)
    {
        libcamera::ControlList next(libcamera::controls::controls);
        if (request->status() == libcamera::Request::RequestComplete)
            completed(request, image(memory_[request->cookie()]), &next);
        if (!running_)
            return;
        request->reuse(libcamera::Request::ReuseBuffers); // also one that a refused control has cancelled
        request->controls().merge(next);
        camera->queueRequest(request);
    }

    std::unique_ptr<libcamera::CameraConfiguration> config_;
    std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
    std::vector<std::unique_ptr<libcamera::Request>> requests_;
    std::vector<void *> memory_;
    std::atomic<bool> running_{true};
};

#endif
