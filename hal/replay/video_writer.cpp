#include "hal/replay/video_writer.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <cmath>
#include <cstdio>

#include "hal/files/output_file.h"
#include "hal/replay/ffmpeg.h"

namespace touchline::hal {
namespace {

using namespace ffmpeg;

constexpr AVRational kTick{1, 90000};  // the clock of MPEG, fine enough for any frame rate

struct MuxerDeleter {
  void operator()(AVFormatContext* context) const { avformat_free_context(context); }
};

// The file, and the error of a callback, because FFmpeg passes on only a number.
struct Stream {
  OutputFile file;
  Result<void> result;
};

// FFmpeg's callbacks. `Byte` is const since FFmpeg 7.
template <class Byte>
int write_bytes(void* opaque, Byte* bytes, int size) {
  auto& stream = *static_cast<Stream*>(opaque);
  const std::string_view view(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  Result<void> written = stream.file.write(view);
  if (written.ok()) return size;
  stream.result = std::move(written);
  return AVERROR(EIO);
}

int64_t seek_to(void* opaque, int64_t position, int whence) {
  if ((whence & ~AVSEEK_FORCE) != SEEK_SET) return AVERROR(ENOSYS);
  auto& stream = *static_cast<Stream*>(opaque);
  Result<void> done = stream.file.seek(static_cast<std::uint64_t>(position));
  if (done.ok()) return position;
  stream.result = std::move(done);
  return AVERROR(EIO);
}

constexpr int kStreamBytes = 65536;

}  // namespace

struct VideoWriter::Output {
  Stream bytes;
  IoPtr stream_out;
  std::unique_ptr<AVFormatContext, MuxerDeleter> file;
  CodecPtr codec;
  FramePtr frame;
  PacketPtr packet;
  ScalerPtr scaler;
  AVStream* stream = nullptr;
};

VideoWriter::VideoWriter() = default;
VideoWriter::~VideoWriter() = default;

Error VideoWriter::fail(ErrorCode code, const std::string& cause) const { return prefixed(path_, {code, cause}); }

// The error of the file contains more information than the muxer's.
Error VideoWriter::fail_writing(int result) const {
  const Result<void>& file = output_->bytes.result;
  return file.ok() ? fail(ErrorCode::kIo, error_text(result)) : file.error();
}

Result<void> VideoWriter::open(const std::string& path, std::uint32_t width_px, std::uint32_t height_px,
                               double rate_hz) {
  const LogCapture log;
  path_ = path;
  if (width_px == 0 || height_px == 0 || width_px % 2 != 0 || height_px % 2 != 0 || !(rate_hz > 0.0)) {
    return fail(ErrorCode::kOutOfRange, "a video needs an even width and height and a rate above 0");
  }
  auto output = std::make_unique<Output>();
  const AVCodec* encoder = avcodec_find_encoder_by_name("libx264");
  const bool h264 = encoder != nullptr;
  if (!h264) encoder = avcodec_find_encoder(AV_CODEC_ID_MPEG4);
  if (encoder == nullptr) return fail(ErrorCode::kUnsupported, "this FFmpeg has no encoder for H.264 or MPEG-4");
  AVFormatContext* file = nullptr;
  if (avformat_alloc_output_context2(&file, nullptr, "mp4", nullptr) < 0) {
    return fail(ErrorCode::kUnsupported, "this FFmpeg cannot write MP4");
  }
  output->file.reset(file);
  output->codec.reset(avcodec_alloc_context3(encoder));
  AVCodecContext& codec = *output->codec;
  codec.width = static_cast<int>(width_px);
  codec.height = static_cast<int>(height_px);
  codec.pix_fmt = AV_PIX_FMT_YUV420P;
  codec.time_base = kTick;
  codec.framerate = av_d2q(rate_hz, 100000);
  codec.colorspace = AVCOL_SPC_SMPTE170M;
  codec.color_range = AVCOL_RANGE_MPEG;
  codec.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // MP4 stores the headers once, at the beginning
  if (h264) {
    av_opt_set(codec.priv_data, "preset", "veryfast", 0);
    av_opt_set(codec.priv_data, "crf", "18", 0);  // lines and small text stay sharp
  } else {
    codec.time_base = av_inv_q(codec.framerate);  // MPEG-4 allows 16 bits for its denominator
    codec.flags |= AV_CODEC_FLAG_QSCALE;
    codec.global_quality = 3 * FF_QP2LAMBDA;
  }
  int result = avcodec_open2(&codec, encoder, nullptr);
  output->stream = avformat_new_stream(file, nullptr);
  if (result < 0 || output->stream == nullptr)
    return fail(ErrorCode::kUnsupported, "the encoder cannot be opened: " + error_text(result));
  avcodec_parameters_from_context(output->stream->codecpar, &codec);
  output->stream->time_base = kTick;
  output->stream->avg_frame_rate = codec.framerate;
  OutputFile& target = output->bytes.file;
  TOUCHLINE_TRY(target.open(path));
  auto* buffer = static_cast<unsigned char*>(av_malloc(kStreamBytes));
  output->stream_out.reset(avio_alloc_context(buffer, kStreamBytes, 1, &output->bytes, nullptr, write_bytes,
                                              target.replaces_file() ? seek_to : nullptr));
  if (output->stream_out == nullptr) return fail(ErrorCode::kIo, "no memory");
  file->pb = output->stream_out.get();
  file->flags |= AVFMT_FLAG_CUSTOM_IO;
  // Without seeking, the index cannot be written when the file is complete; a fragmented MP4 needs no index.
  if (!target.replaces_file()) av_opt_set(file->priv_data, "movflags", "frag_keyframe+empty_moov+default_base_moof", 0);
  output_ = std::move(output);
  result = avformat_write_header(file, nullptr);
  if (result < 0) return fail_writing(result);

  output_->packet.reset(av_packet_alloc());
  output_->frame.reset(av_frame_alloc());
  AVFrame& frame = *output_->frame;
  frame.format = codec.pix_fmt;
  frame.width = codec.width;
  frame.height = codec.height;
  result = av_frame_get_buffer(&frame, 0);
  output_->scaler.reset(sws_getContext(codec.width, codec.height, AV_PIX_FMT_BGR0, codec.width, codec.height,
                                       codec.pix_fmt, SWS_BICUBIC | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
  if (result < 0 || output_->scaler == nullptr)
    return fail(ErrorCode::kUnsupported, "FFmpeg cannot convert to the encoder's pixel format");
  return {};
}

Result<void> VideoWriter::drain() {
  for (;;) {
    int result = avcodec_receive_packet(output_->codec.get(), output_->packet.get());
    if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return {};
    if (result >= 0) {
      av_packet_rescale_ts(output_->packet.get(), output_->codec->time_base, output_->stream->time_base);
      result = av_interleaved_write_frame(output_->file.get(), output_->packet.get());
    }
    if (result < 0) return fail_writing(result);
  }
}

Result<void> VideoWriter::write(std::span<const std::uint8_t> bgrx, std::size_t stride_bytes, Duration stamp) {
  const LogCapture log;
  if (output_ == nullptr) return fail(ErrorCode::kIo, "is not open");
  AVFrame& frame = *output_->frame;
  if (stride_bytes < 4 * static_cast<std::size_t>(frame.width) ||
      bgrx.size() < stride_bytes * static_cast<std::size_t>(frame.height)) {
    return fail(ErrorCode::kOutOfRange, "the picture is smaller than the video");
  }
  if (av_frame_make_writable(&frame) < 0) return fail(ErrorCode::kIo, "no memory");
  const std::uint8_t* const data[4] = {bgrx.data(), nullptr, nullptr, nullptr};
  const int stride[4] = {static_cast<int>(stride_bytes), 0, 0, 0};
  sws_scale(output_->scaler.get(), data, stride, 0, frame.height, frame.data, frame.linesize);
  frame.pts = av_rescale_q(stamp.count(), AVRational{1, 1000000000}, output_->codec->time_base);
  const int result = avcodec_send_frame(output_->codec.get(), &frame);
  if (result < 0) return fail(ErrorCode::kIo, error_text(result));
  return drain();
}

Result<void> VideoWriter::finish() {
  const LogCapture log;
  if (output_ == nullptr) return fail(ErrorCode::kIo, "is not open");
  int result = avcodec_send_frame(output_->codec.get(), nullptr);
  if (result < 0) return fail(ErrorCode::kIo, error_text(result));
  TOUCHLINE_TRY(drain());
  result = av_write_trailer(output_->file.get());
  avio_flush(output_->file->pb);
  if (result >= 0) result = output_->file->pb->error;
  if (result < 0) return fail_writing(result);
  Result<void> committed = output_->bytes.file.commit();
  output_.reset();
  return committed;
}

}  // namespace touchline::hal
