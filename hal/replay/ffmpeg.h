#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <string>

// Smart pointers for FFmpeg's objects, and messages from its log. Private to hal/replay.
namespace touchline::hal::ffmpeg {

template <auto release>
struct Deleter {
  template <class T>
  void operator()(T* object) const {
    release(&object);
  }
};
using FramePtr = std::unique_ptr<AVFrame, Deleter<av_frame_free>>;
using PacketPtr = std::unique_ptr<AVPacket, Deleter<av_packet_free>>;
/// Frees a stream that we have created, because FFmpeg does not free it with the file.
struct IoDeleter {
  void operator()(AVIOContext* context) const {
    av_freep(&context->buffer);
    avio_context_free(&context);
  }
};
using IoPtr = std::unique_ptr<AVIOContext, IoDeleter>;
using CodecPtr = std::unique_ptr<AVCodecContext, Deleter<avcodec_free_context>>;
using InputPtr = std::unique_ptr<AVFormatContext, Deleter<avformat_close_input>>;

struct ScalerDeleter {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
using ScalerPtr = std::unique_ptr<SwsContext, ScalerDeleter>;

/// Returns FFmpeg's text for one of its error codes ("No such file or directory").
std::string error_text(int code);

/// During its lifetime, captures the first warning and the first error that FFmpeg logs on this thread. Other messages
/// are dropped, so that nothing is printed to the terminal. Decoders must use thread_count 1.
class LogCapture {
 public:
  LogCapture();
  ~LogCapture();
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  /// Return the first line of this severity; empty if there was none.
  [[nodiscard]] const std::string& first_error() const { return first_error_; }
  [[nodiscard]] const std::string& first_warning() const { return first_warning_; }
  void add(int level, const std::string& line);

 private:
  LogCapture* outer_;
  std::string first_error_, first_warning_;
};

}  // namespace touchline::hal::ffmpeg
