#include "hal/replay/replay_camera.h"

#include <filesystem>

#include "hal/replay/frame_converter.h"
#include "hal/replay/video_reader.h"

namespace touchline::hal {
namespace {

constexpr double kPictureRateHz = 30.0;  // the rate of the paper
// Number of buffers: one in the pipeline, one held by a recorder, and one being filled.
constexpr std::size_t kBuffers = 3;

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

struct ReplayCamera::Input {
  explicit Input(PixelFormat format) : converter(format) {}
  std::unique_ptr<ffmpeg::ReplaySource> source;
  ffmpeg::FrameConverter converter;
  ffmpeg::SourceFrame decoded;  // the next frame, if `pending`
  bool pending = false;
  std::array<ffmpeg::ConvertedFrame, kBuffers> buffer;
  std::array<bool, kBuffers> leased{};
};

ReplayCamera::ReplayCamera(ReplayParameters parameters, Clock* pace)
    : parameters_(std::move(parameters)), pace_(pace) {}
ReplayCamera::~ReplayCamera() = default;

std::uint64_t ReplayCamera::frame_count() const { return input_ == nullptr ? 0 : input_->source->frame_count(); }

Error ReplayCamera::failed(ErrorCode code, const std::string& cause) const {
  return failure(code, "%s: %s", parameters_.path.c_str(), cause.c_str());
}

Result<void> ReplayCamera::fetch() {
  Result<void> decoded = input_->source->next(input_->decoded);
  file_ = input_->decoded.file;
  if (!decoded.ok()) return decoded;
  const AVFrame& picture = *input_->decoded.picture;
  const auto width = static_cast<std::uint32_t>(picture.width), height = static_cast<std::uint32_t>(picture.height);
  if (width > kMaxFrameWidth || height > kMaxFrameHeight) {
    return failed(ErrorCode::kUnsupported, file_ + " is " + size_text(width, height) + ", larger than " +
                                               size_text(kMaxFrameWidth, kMaxFrameHeight));
  }
  if (info_.width_px != 0 && (info_.width_px != width || info_.height_px != height)) {
    return failed(ErrorCode::kInconsistent, file_ + " is " + size_text(width, height) + ", but " + first_file_ +
                                                " is " + size_text(info_.width_px, info_.height_px));
  }
  input_->pending = true;
  return {};
}

// Gets the next frame as fetch() does, but skips damaged pictures if `skip_damaged` is set. A damaged picture leaves a
// gap in the numbers, like a frame that a driver has lost.
Result<void> ReplayCamera::fetch_undamaged() {
  for (;;) {
    Result<void> fetched = fetch();
    if (fetched.code() != ErrorCode::kCorruptFrame) return fetched;
    ++sequence_;
    if (!parameters_.skip_damaged) return fetched;
    ++damaged_;
  }
}

Result<void> ReplayCamera::do_open() {
  do_close();
  std::error_code error;
  const std::filesystem::path path(parameters_.path);
  if (!std::filesystem::exists(path, error)) {
    return failed(error == std::errc::permission_denied ? ErrorCode::kPermission : ErrorCode::kNotFound,
                  error ? error.message() : "No such file or directory");
  }
  input_ = std::make_unique<Input>(parameters_.format);
  if (std::filesystem::is_directory(path, error) || ffmpeg::is_picture_name(path)) {
    const double rate_hz = parameters_.rate_hz > 0.0 ? parameters_.rate_hz : kPictureRateHz;
    input_->source = std::make_unique<ffmpeg::PictureSource>(path, rate_hz);
  } else {
    input_->source = std::make_unique<ffmpeg::VideoReader>(parameters_.path, parameters_.rate_hz);
  }
  Result<void> opened = input_->source->open();
  // The first frame contains the size and shows whether the input can be decoded.
  if (opened.ok()) opened = fetch_undamaged();
  if (!opened.ok()) {
    input_.reset();
    if (opened.code() == ErrorCode::kEndOfStream && damaged_ > 0) {
      return failed(ErrorCode::kCorruptFrame, "none of its " + std::to_string(damaged_) + " pictures can be decoded");
    }
    return opened;
  }
  first_file_ = file_;
  info_ = {parameters_.format, static_cast<std::uint16_t>(input_->decoded.picture->width),
           static_cast<std::uint16_t>(input_->decoded.picture->height), input_->source->rate_hz()};
  return {};
}

Result<void> ReplayCamera::do_start() {
  if (input_ == nullptr) {
    return failed(ErrorCode::kIo, "is not open");
  }
  running_ = true;
  begin_ = pace_ == nullptr ? Instant{} : pace_->now() - input_->decoded.stamp;
  return {};
}

Result<FrameLease> ReplayCamera::do_wait(Instant deadline) {
  if (!running_) {
    return failed(ErrorCode::kIo, "is not started");
  }
  std::uint32_t slot = 0;
  while (slot < kBuffers && input_->leased[slot]) ++slot;
  if (slot == kBuffers) {
    return failed(ErrorCode::kBusy, "all buffers are held");
  }
  if (!input_->pending) {
    TOUCHLINE_TRY(fetch_undamaged());
  }
  const Instant stamp = begin_ + input_->decoded.stamp;
  if (pace_ != nullptr && pace_->now() < stamp) {
    pace_->sleep_until(stamp < deadline ? stamp : deadline);
    if (pace_->now() < stamp) {
      return failed(ErrorCode::kTimeout, "the next frame is not due yet");
    }
  }
  input_->pending = false;
  ffmpeg::ConvertedFrame& converted = input_->buffer[slot];
  if (const Result<void> done = input_->converter.convert(*input_->decoded.picture, converted); !done.ok()) {
    return failed(done.code(), file_ + " " + done.text());
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
  damaged_ = 0;
  latest_ = {};
}

}  // namespace touchline::hal
