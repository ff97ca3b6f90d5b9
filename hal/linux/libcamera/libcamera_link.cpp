#include "hal/linux/libcamera/libcamera_link.h"

#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/control_ids.h>
#include <libcamera/formats.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/property_ids.h>
#include <libcamera/request.h>

#include <cerrno>
#include <cstdlib>
#include <utility>

#include "hal/device_parameters.h"
#include "hal/linux/libcamera/libcamera_numbers.h"
#include "hal/linux/libcamera/libcamera_version.h"
#include "hal/linux/shared_instance.h"

namespace touchline::hal {
namespace {

libcamera::PixelFormat format_of(PixelFormat format) { return libcamera::PixelFormat(info_of(format).drm); }

std::string name_of(const libcamera::PixelFormat& format) {
  for (const PixelFormatInfo& info : kPixelFormatTable) {
    if (format_of(info.format) == format) return std::string(info.word);
  }
  return format.toString();
}

std::string list_formats(const libcamera::StreamFormats& formats) {
  const auto text = [](const libcamera::Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
  };
  std::string offers;
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    offers += (offers.empty() ? "" : "; ") + name_of(format);
    const std::vector<libcamera::Size> sizes = formats.sizes(format);
    for (const libcamera::Size& size : sizes) offers += " " + text(size);
    const libcamera::SizeRange range = formats.range(format);
    if (sizes.empty()) offers += " " + text(range.min) + " to " + text(range.max);
  }
  return offers.empty() ? "nothing" : offers;
}

class RunningManager final : public libcamera::CameraManager {
 public:
  RunningManager() = default;
  RunningManager(const RunningManager&) = delete;
  RunningManager& operator=(const RunningManager&) = delete;
  ~RunningManager() override { stop(); }
};

/// libcamera allows one camera manager per process, so all users share it.
SharedInstance<RunningManager>& shared_manager() {
  static SharedInstance<RunningManager> manager;
  return manager;
}

RunningManager* take_manager(int& error) {
  error = 0;
  return shared_manager().acquire([&error]() -> std::unique_ptr<RunningManager> {
    // By default libcamera logs every step to standard error; the variable can turn this on again.
    ::setenv("LIBCAMERA_LOG_LEVELS", "*:WARN", 0);
    auto manager = std::make_unique<RunningManager>();
    error = -manager->start();
    return error == 0 ? std::move(manager) : nullptr;
  });
}

LibcameraName name_of(const libcamera::Camera& camera) {
  LibcameraName name;
  name.id = camera.id();
  name.model = camera.properties().get(libcamera::properties::Model).value_or("no name");
  name.external =
      camera.properties().get(libcamera::properties::Location) == libcamera::properties::CameraLocationExternal;
  return name;
}

class Link final : public LibcameraLink {
 public:
  Link() = default;
  ~Link() override { Link::release(); }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  int cameras(std::vector<LibcameraName>& found) override {
    int error = 0;
    if (manager_ == nullptr) manager_ = take_manager(error);
    if (manager_ == nullptr) return error;
    found.clear();
    for (const std::shared_ptr<libcamera::Camera>& camera : manager_->cameras()) found.push_back(name_of(*camera));
    return 0;
  }

  int acquire(const std::string& id, LibcameraSink& sink) override {
    camera_ = manager_->get(id);
    if (camera_ == nullptr) return ENOENT;
    if (const int error = camera_->acquire(); error != 0) {
      camera_.reset();
      return -error;
    }
    sink_ = &sink;
    external_ = name_of(*camera_).external;
    camera_->requestCompleted.connect(this, &Link::completed);
    camera_->disconnected.connect(this, &Link::disconnected);
    return 0;
  }

  int configure(LibcameraStream& requested, std::string& offers) override {
    configuration_ = camera_->generateConfiguration({libcamera::StreamRole::VideoRecording});
    if (configuration_ == nullptr || configuration_->empty()) return ENOTSUP;
    libcamera::StreamConfiguration& stream = configuration_->at(0);
    const libcamera::PixelFormat format = format_of(requested.format);
    const libcamera::Size size(requested.width_px, requested.height_px);
    stream.pixelFormat = format;
    stream.size = size;
    stream.bufferCount = static_cast<unsigned>(requested.buffers);
    const ColorSpace space = color_space(requested.format);
    if (space == ColorSpace::kYuv) stream.colorSpace = libcamera::ColorSpace::Smpte170m;
    if (space == ColorSpace::kYuvFullRange) stream.colorSpace = libcamera::ColorSpace::Sycc;
    const libcamera::CameraConfiguration::Status status = configuration_->validate();
    if (status == libcamera::CameraConfiguration::Invalid || stream.pixelFormat != format || stream.size != size) {
      offers = list_formats(stream.formats());
      return EINVAL;
    }
    if (const int error = camera_->configure(configuration_.get()); error != 0) return -error;
    requested.stride_bytes = stream.stride;
    requested.frame_bytes = stream.frameSize;
    requested.buffers = stream.bufferCount;
    requested.mirrored = version::is_mirrored(*configuration_);
    requested.full_range = stream.colorSpace && stream.colorSpace->range == libcamera::ColorSpace::Range::Full;
    return 0;
  }

  LibcameraLimits limits() override { return limits_of(camera_->controls()); }

  int use_buffers(const std::vector<DmaBuffer>& buffers) override {
    for (const DmaBuffer& buffer : buffers) {
      std::vector<libcamera::FrameBuffer::Plane> planes;
      for (const DmaPlane& plane : buffer.plane) {
        if (plane.file < 0) continue;
        libcamera::FrameBuffer::Plane& added = planes.emplace_back();
        // If all planes have the same descriptor, libcamera knows that they share one memory.
        added.fd = planes.size() > 1 ? planes.front().fd : libcamera::SharedFD(plane.file);
        added.offset = static_cast<unsigned>(plane.offset);
        added.length = static_cast<unsigned>(plane.length);
      }
      own_buffers_.push_back(std::make_unique<libcamera::FrameBuffer>(planes));
    }
    for (const auto& buffer : own_buffers_) {
      if (const int error = make_request(*buffer); error != 0) return error;
    }
    return 0;
  }

  int make_buffers(std::vector<DmaBuffer>& buffers) override {
    allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
    libcamera::Stream* const stream = configuration_->at(0).stream();
    if (const int made = allocator_->allocate(stream); made < 0) return -made;
    for (const auto& buffer : allocator_->buffers(stream)) {
      DmaBuffer& added = buffers.emplace_back();
      std::size_t count = 0;
      for (const libcamera::FrameBuffer::Plane& plane : buffer->planes()) {
        if (plane.length == 0) continue;
        if (count == added.plane.size()) return ENOTSUP;
        const bool reported = plane.offset != libcamera::FrameBuffer::Plane::kInvalidOffset;
        added.plane[count++] = {plane.fd.get(), reported ? plane.offset : 0, plane.length};
      }
      if (const int error = make_request(*buffer); error != 0) return error;
    }
    return 0;
  }

  int start(const LibcameraNumbers& controls) override {
    libcamera::ControlList list(camera_->controls());
    set_controls(list, camera_->controls(), controls, external_);
    return -camera_->start(&list);
  }

  void adjust(const LibcameraNumbers& controls) override { adjusted_ = controls; }

  int queue(std::uint32_t buffer) override {
    libcamera::Request& request = *requests_[buffer];
    if (request.status() != libcamera::Request::RequestPending) request.reuse(libcamera::Request::ReuseBuffers);
    if (adjusted_) set_controls(request.controls(), camera_->controls(), *adjusted_, external_);
    adjusted_.reset();
    return -camera_->queueRequest(&request);
  }

  void stop() override {
    static_cast<void>(camera_->stop());  // fails if the camera has disappeared
    adjusted_.reset();
    // Requests that were not completed can be queued again.
    for (const auto& request : requests_) request->reuse(libcamera::Request::ReuseBuffers);
  }

  void release() override {
    if (camera_ != nullptr) {
      camera_->requestCompleted.disconnect(this);
      camera_->disconnected.disconnect(this);
      requests_.clear();
      own_buffers_.clear();
      allocator_.reset();
      configuration_.reset();
      static_cast<void>(camera_->release());
      camera_.reset();
    }
    if (std::exchange(manager_, nullptr) != nullptr) shared_manager().release();
  }

 private:
  int make_request(libcamera::FrameBuffer& buffer) {
    std::unique_ptr<libcamera::Request> request = camera_->createRequest(requests_.size());
    if (request == nullptr) return ENODEV;
    const int error = request->addBuffer(configuration_->at(0).stream(), &buffer);
    requests_.push_back(std::move(request));
    return -error;
  }

  void completed(libcamera::Request* request) {
    LibcameraFrame frame;
    frame.buffer = static_cast<std::uint32_t>(request->cookie());
    const libcamera::FrameBuffer* const buffer = request->findBuffer(configuration_->at(0).stream());
    const libcamera::FrameMetadata& data = buffer->metadata();
    if (request->status() == libcamera::Request::RequestCancelled) {
      frame.state = LibcameraFrame::State::kCancelled;
    } else if (data.status != libcamera::FrameMetadata::FrameSuccess) {
      frame.state = LibcameraFrame::State::kDamaged;
    }
    frame.sequence = data.sequence;
    for (const libcamera::FrameMetadata::Plane& plane : data.planes()) frame.bytes += plane.bytesused;
    const auto stamp = request->metadata().get(libcamera::controls::SensorTimestamp);
    frame.stamp_ns = stamp.value_or(static_cast<std::int64_t>(data.timestamp));
    frame.reported = reported_by(request->metadata());
    sink_->frame_done(frame);
  }

  void disconnected() { sink_->camera_gone(); }

  RunningManager* manager_ = nullptr;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<libcamera::FrameBuffer>> own_buffers_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  std::optional<LibcameraNumbers> adjusted_;
  LibcameraSink* sink_ = nullptr;
  bool external_ = false;
};

}  // namespace

std::unique_ptr<LibcameraLink> make_libcamera_link() { return std::make_unique<Link>(); }

}  // namespace touchline::hal
