#include "hal/replay/video_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/types.h"
#include "hal/files/interruption.h"

namespace touchline::hal::ffmpeg {
namespace {

// Frame rate assumed for a stream without one: the rate of the paper.
constexpr double kUnknownRateHz = 30.0;

ErrorCode code_of(int error) {
  if (error == AVERROR(ENOENT)) return ErrorCode::kNotFound;
  if (error == AVERROR(EACCES) || error == AVERROR(EPERM)) return ErrorCode::kPermission;
  if (error == AVERROR_INVALIDDATA) return ErrorCode::kUnsupported;
  return ErrorCode::kIo;
}

// FFmpeg's callback: reads from a FIFO or device, until the process is told to end.
int read_bytes(void* opaque, std::uint8_t* bytes, int size) {
  const int file = *static_cast<const int*>(opaque);
  for (;;) {
    if (!wait_until_ready(file, Ready::kRead)) return AVERROR_EXIT;
    const ssize_t count = ::read(file, bytes, static_cast<std::size_t>(size));
    if (count > 0) return static_cast<int>(count);
    if (count == 0) return AVERROR_EOF;
    if (errno != EINTR && errno != EAGAIN) return AVERROR(errno);
  }
}

constexpr int kStreamInBytes = 65536;

}  // namespace

VideoReader::~VideoReader() {
  input_.reset();  // reads from the stream until it is closed
  if (file_ >= 0) ::close(file_);
}

// Opens a FIFO or a device here, because FFmpeg would wait for the writer of a FIFO forever. FFmpeg opens regular files
// itself.
Result<void> VideoReader::open_stream() {
  input_.reset();
  stream_in_.reset();
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return {};
  file_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file_ < 0) return fail(code_of(AVERROR(errno)), error_text(AVERROR(errno)));
  auto* const buffer = static_cast<unsigned char*>(av_malloc(kStreamInBytes));
  stream_in_.reset(avio_alloc_context(buffer, kStreamInBytes, 0, &file_, read_bytes, nullptr, nullptr));
  return {};
}

Error VideoReader::fail(ErrorCode code, const std::string& cause) const {
  return failure(code, "%s: %s", path_.c_str(), cause.c_str());
}

Result<void> VideoReader::open() {
  const LogCapture log;
  frames_read_ = frame_count_ = 0;
  first_pts_ = AV_NOPTS_VALUE;
  last_stamp_ = {};
  codec_.reset();
  TOUCHLINE_TRY(open_stream());
  AVFormatContext* input = nullptr;
  if (stream_in_ != nullptr) {
    input = avformat_alloc_context();
    input->pb = stream_in_.get();
  }
  // Without "file:", FFmpeg would take the part before a colon in the name for a protocol.
  int result = avformat_open_input(&input, ("file:" + path_).c_str(), nullptr, nullptr);
  if (result < 0) return fail(code_of(result), result == AVERROR_INVALIDDATA ? "is not a video" : error_text(result));
  input_.reset(input);
  // Reject text files, which FFmpeg can "play" as a terminal screen.
  if (std::strcmp(input_->iformat->name, "tty") == 0)
    return fail(ErrorCode::kUnsupported, "is a text file, not a video");
  result = avformat_find_stream_info(input_.get(), nullptr);
  if (result < 0) return fail(code_of(result), "its streams cannot be read (" + error_text(result) + ")");
  const AVCodec* decoder = nullptr;
  stream_ = av_find_best_stream(input_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (stream_ == AVERROR_DECODER_NOT_FOUND) return fail(ErrorCode::kUnsupported, "there is no decoder for its video");
  if (stream_ < 0) return fail(ErrorCode::kUnsupported, "contains no video stream");
  const AVStream& stream = *input_->streams[stream_];
  codec_.reset(avcodec_alloc_context3(decoder));
  packet_.reset(av_packet_alloc());
  result = avcodec_parameters_to_context(codec_.get(), stream.codecpar);
  if (result >= 0) {
    codec_->max_pixels = std::int64_t{kMaxFrameWidth} * kMaxFrameHeight;
    codec_->pkt_timebase = stream.time_base;
    codec_->thread_count = 0;  // one per CPU; the pictures do not depend on it
    result = avcodec_open2(codec_.get(), decoder, nullptr);
  }
  if (result < 0) return fail(ErrorCode::kUnsupported, "its video cannot be decoded (" + error_text(result) + ")");
  rate_hz_ = forced_rate_hz_;
  if (rate_hz_ <= 0.0) rate_hz_ = av_q2d(stream.avg_frame_rate);
  if (!std::isfinite(rate_hz_) || rate_hz_ <= 0.0) rate_hz_ = kUnknownRateHz;
  if (stream.nb_frames > 0) frame_count_ = static_cast<std::uint64_t>(stream.nb_frames);
  return {};
}

Duration VideoReader::stamp_of(const AVFrame& frame) {
  Duration stamp = last_stamp_ + from_seconds(1.0 / rate_hz_);
  if (forced_rate_hz_ > 0.0) {
    stamp = from_seconds(static_cast<double>(frames_read_) / forced_rate_hz_);
  } else if (frames_read_ == 0) {
    first_pts_ = frame.best_effort_timestamp;
    stamp = {};
  } else if (frame.best_effort_timestamp != AV_NOPTS_VALUE && first_pts_ != AV_NOPTS_VALUE) {
    const std::int64_t ticks = frame.best_effort_timestamp - first_pts_;
    const Duration own(av_rescale_q(ticks, input_->streams[stream_]->time_base, AVRational{1, 1000000000}));
    if (own > last_stamp_) stamp = own;
  }
  last_stamp_ = stamp;
  return stamp;
}

Result<void> VideoReader::feed_decoder() {
  for (;;) {
    int result = av_read_frame(input_.get(), packet_.get());
    if (result == AVERROR_EOF && input_->pb != nullptr && input_->pb->error < 0) result = input_->pb->error;
    if (result == AVERROR_EOF) {
      result = avcodec_send_packet(codec_.get(), nullptr);
      return result >= 0 || result == AVERROR_EOF ? Result<void>() : fail(ErrorCode::kIo, error_text(result));
    }
    if (result < 0) {
      return fail(ErrorCode::kIo,
                  "ends early, after frame " + std::to_string(frames_read_) + " (" + error_text(result) + ")");
    }
    const bool wanted = packet_->stream_index == stream_;
    const bool damaged = (packet_->flags & AV_PKT_FLAG_CORRUPT) != 0;
    if (wanted && !damaged) result = avcodec_send_packet(codec_.get(), packet_.get());
    av_packet_unref(packet_.get());
    if (!wanted) continue;
    if (damaged || result < 0) {
      return fail(ErrorCode::kCorruptFrame, "damaged after frame " + std::to_string(frames_read_) + " (" +
                                                (damaged ? "packet cut off" : error_text(result)) + ")");
    }
    return {};
  }
}

Result<void> VideoReader::next(SourceFrame& out) {
  const LogCapture log;
  if (codec_ == nullptr) return fail(ErrorCode::kIo, "is not open");
  out.file = std::filesystem::path(path_).filename().string();
  out.picture.reset(av_frame_alloc());
  for (;;) {
    const int result = avcodec_receive_frame(codec_.get(), out.picture.get());
    if (result >= 0) break;
    if (result == AVERROR_EOF) {
      return fail(ErrorCode::kEndOfStream, frames_read_ == 0 ? "contains no frame" : "no more frames");
    }
    if (result != AVERROR(EAGAIN)) {
      return fail(ErrorCode::kCorruptFrame,
                  "damaged after frame " + std::to_string(frames_read_) + " (" + error_text(result) + ")");
    }
    TOUCHLINE_TRY(feed_decoder());
  }
  out.stamp = stamp_of(*out.picture);
  ++frames_read_;
  if (out.picture->decode_error_flags != 0 || (out.picture->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
    return fail(ErrorCode::kCorruptFrame, "frame " + std::to_string(frames_read_ - 1) + " is damaged");
  }
  return {};
}

}  // namespace touchline::hal::ffmpeg
