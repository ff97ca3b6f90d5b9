#include "hal/replay/replay_camera.h"

#include <filesystem>

#include "hal/replay/frame_converter.h"
#include "hal/replay/video_reader.h"

namespace touchline::hal {
namespace {

constexpr double kPictureRateHz = 30.0;  // the paper's
// One in the pipeline, one that a recorder may still hold, one being filled.
constexpr std::size_t kBuffers = 3;

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

struct ReplayCamera::Input {
  explicit Input(PixelFormat format) : converter(format) {}
  std::unique_ptr<ffmpeg::ReplaySource> source;
  ffmpeg::FrameConverter converter;
  ffmpeg::SourceFrame decoded;  // the next frame to hand out, when `pending`
  bool pending = false;
  std::array<ffmpeg::ConvertedFrame, kBuffers> buffer;
  std::array<bool, kBuffers> leased{};
};

ReplayCamera::ReplayCamera(ReplayParameters parameters, Clock* pace)
    : parameters_(std::move(parameters)), pace_(pace) {}
ReplayCamera::~ReplayCamera() = default;

std::uint64_t ReplayCamera::frame_count() const { return input_ == nullptr ? 0 : input_->source->frame_count(); }

Status ReplayCamera::fetch() {
  const Status status = input_->source->next(input_->decoded);
  file_ = input_->decoded.file;
  if (!status.ok()) {
    reason_ = input_->source->reason();
    return status;
  }
  const AVFrame& picture = *input_->decoded.picture;
  const auto width = static_cast<std::uint32_t>(picture.width), height = static_cast<std::uint32_t>(picture.height);
  if (width > kMaxFrameWidth || height > kMaxFrameHeight) {
    reason_ = parameters_.path + ": " + file_ + " is " + size_text(width, height) + ", larger than " +
              size_text(kMaxFrameWidth, kMaxFrameHeight);
    return ErrorCode::kUnsupported;
  }
  if (info_.width_px != 0 && (info_.width_px != width || info_.height_px != height)) {
    reason_ = parameters_.path + ": " + file_ + " is " + size_text(width, height) + ", but " + first_file_ + " is " +
              size_text(info_.width_px, info_.height_px);
    return ErrorCode::kInconsistent;
  }
  input_->pending = true;
  return {};
}

Status ReplayCamera::do_open() {
  do_close();
  reason_.clear();
  std::error_code error;
  const std::filesystem::path path(parameters_.path);
  if (!std::filesystem::exists(path, error)) {
    reason_ = parameters_.path + ": " + (error ? error.message() : "No such file or directory");
    return error == std::errc::permission_denied ? ErrorCode::kPermission : ErrorCode::kNotFound;
  }
  input_ = std::make_unique<Input>(parameters_.format);
  if (std::filesystem::is_directory(path, error) || ffmpeg::is_picture_name(path)) {
    const double rate_hz = parameters_.rate_hz > 0.0 ? parameters_.rate_hz : kPictureRateHz;
    input_->source = std::make_unique<ffmpeg::PictureSource>(path, rate_hz);
  } else {
    input_->source = std::make_unique<ffmpeg::VideoReader>(parameters_.path, parameters_.rate_hz);
  }
  Status status = input_->source->open();
  if (!status.ok()) reason_ = input_->source->reason();
  // The first frame tells the size, and whether anything can be decoded at all.
  if (status.ok()) status = fetch();
  if (!status.ok()) {
    input_.reset();
    return status;
  }
  first_file_ = file_;
  info_ = {parameters_.format, static_cast<std::uint16_t>(input_->decoded.picture->width),
           static_cast<std::uint16_t>(input_->decoded.picture->height), input_->source->rate_hz()};
  return {};
}

Status ReplayCamera::do_start() {
  if (input_ == nullptr) {
    reason_ = parameters_.path + ": is not open";
    return ErrorCode::kIo;
  }
  running_ = true;
  begin_ = pace_ == nullptr ? Instant{} : pace_->now() - input_->decoded.stamp;
  return {};
}

Result<FrameLease> ReplayCamera::do_wait(Instant deadline) {
  if (!running_) {
    reason_ = parameters_.path + ": is not started";
    return ErrorCode::kIo;
  }
  std::uint32_t slot = 0;
  while (slot < kBuffers && input_->leased[slot]) ++slot;
  if (slot == kBuffers) {
    reason_ = parameters_.path + ": all buffers are held";
    return ErrorCode::kBusy;
  }
  if (!input_->pending) {
    if (Status s = fetch(); !s.ok()) {
      if (s.code() == ErrorCode::kCorruptFrame) ++sequence_;  // a gap, as a driver would count it
      return s.code();
    }
  }
  const Instant stamp = begin_ + input_->decoded.stamp;
  if (pace_ != nullptr && pace_->now() < stamp) {
    pace_->sleep_until(stamp < deadline ? stamp : deadline);
    if (pace_->now() < stamp) {
      reason_ = parameters_.path + ": the next frame is not due yet";
      return ErrorCode::kTimeout;
    }
  }
  input_->pending = false;
  ffmpeg::ConvertedFrame& converted = input_->buffer[slot];
  if (Status s = input_->converter.convert(*input_->decoded.picture, converted); !s.ok()) {
    reason_ = parameters_.path + ": " + file_ + " cannot be converted to the format asked for";
    return s.code();
  }
  input_->leased[slot] = true;
  latest_ = stamp;
  Frame frame = converted.view;
  frame.capture_time = stamp;
  frame.sequence = sequence_++;
  return FrameLease(*this, frame, slot);
}

void ReplayCamera::do_release(std::uint32_t buffer) noexcept {
  if (input_ != nullptr) input_->leased[buffer] = false;
}

void ReplayCamera::do_stop() { running_ = false; }

void ReplayCamera::do_close() {
  running_ = false;
  input_.reset();
  info_ = {};
  sequence_ = 0;
  latest_ = {};
}

}  // namespace touchline::hal
