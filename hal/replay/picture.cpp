#include "hal/replay/picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cinttypes>
#include <span>

#include "core/types.h"
#include "hal/files/input_file.h"
#include "hal/replay/frame_converter.h"
#include "hal/replay/picture_decoder.h"

namespace touchline::hal {
namespace {

using namespace ffmpeg;

// Not inlined: gcc 12 would falsely warn that a short string may be uninitialized.
[[gnu::noinline]] AVCodecID codec_of(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return AV_CODEC_ID_PNG;
  if (bytes.starts_with("\xff\xd8\xff")) return AV_CODEC_ID_MJPEG;
  if (bytes.size() > 2 && bytes[0] == 'P') {
    if (bytes[1] == '6' || bytes[1] == '3') return AV_CODEC_ID_PPM;
    if (bytes[1] == '5' || bytes[1] == '2') return AV_CODEC_ID_PGM;
  }
  return AV_CODEC_ID_NONE;
}

/// Returns true if the decoder failed because of the size. Some decoders report this only in the log.
bool is_too_large(const LogCapture& log, const AVCodecContext& codec, std::int64_t max_pixels) {
  return std::int64_t{codec.width} * codec.height > max_pixels || log.first_error().starts_with("Picture size");
}

}  // namespace

namespace ffmpeg {

Result<FramePtr> decode_picture(const std::string& path, std::int64_t max_pixels) {
  TOUCHLINE_TRY_ASSIGN(std::string bytes, read_file(path, kMaxDataFileBytes));
  if (bytes.empty()) {
    return failure(ErrorCode::kCorruptFrame, "%s: the file is empty", path.c_str());
  }
  const AVCodecID kind = codec_of(bytes);
  const AVCodec* decoder = kind == AV_CODEC_ID_NONE ? nullptr : avcodec_find_decoder(kind);
  if (decoder == nullptr) {
    return failure(ErrorCode::kUnsupported, "%s: is not a PNG, PPM or JPEG picture", path.c_str());
  }
  const std::size_t size = bytes.size();
  bytes.append(AV_INPUT_BUFFER_PADDING_SIZE, '\0');  // decoders read beyond the end
  const LogCapture log;
  CodecPtr codec(avcodec_alloc_context3(decoder));
  PacketPtr packet(av_packet_alloc());
  FramePtr out(av_frame_alloc());
  // Damage must be an error, but by default FFmpeg returns the part that it could decode and logs a message.
  codec->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
  codec->thread_count = 1;
  codec->max_pixels = max_pixels;  // checked by FFmpeg before it allocates the frame
  int result = avcodec_open2(codec.get(), decoder, nullptr);
  packet->data = reinterpret_cast<std::uint8_t*>(bytes.data());
  packet->size = static_cast<int>(size);
  if (result >= 0) result = avcodec_send_packet(codec.get(), packet.get());
  if (result >= 0) result = avcodec_send_packet(codec.get(), nullptr);
  if (result >= 0) result = avcodec_receive_frame(codec.get(), out.get());
  // A truncated JPEG only causes a warning ("EOI missing, emulating").
  const std::string& message = log.first_error().empty() ? log.first_warning() : log.first_error();
  const bool damaged = !log.first_error().empty() || (kind == AV_CODEC_ID_MJPEG && !log.first_warning().empty());
  if (result < 0 && is_too_large(log, *codec, max_pixels)) {
    const std::string& details = log.first_error();
    return failure(ErrorCode::kOutOfRange, "%s: the picture has more than %" PRId64 " pixels%s%s%s", path.c_str(),
                   max_pixels, details.empty() ? "" : " (", details.c_str(), details.empty() ? "" : ")");
  }
  if (result < 0 || damaged || out->decode_error_flags != 0 || (out->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
    return failure(ErrorCode::kCorruptFrame, "%s: truncated or damaged (%s)", path.c_str(),
                   message.empty() ? error_text(result).c_str() : message.c_str());
  }
  return out;
}

}  // namespace ffmpeg

Result<Picture> read_picture(const std::string& path, std::int64_t max_pixels) {
  TOUCHLINE_TRY_ASSIGN(const FramePtr frame, decode_picture(path, max_pixels));
  const auto width = static_cast<std::size_t>(frame->width), height = static_cast<std::size_t>(frame->height);
  Picture out;
  out.width_px = static_cast<std::uint32_t>(width);
  out.height_px = static_cast<std::uint32_t>(height);
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame->format));
  std::vector<std::uint16_t> line;
  bool converted = false;
  if (stored_as_rgb(*frame) && layout->comp[0].depth > 8) {
    out.rgb16.resize(3 * width * height);
    converted = read_rgb(*frame, line, out.rgb16.data(), 3 * width);
  } else if (stored_as_rgb(*frame)) {
    out.rgb8.resize(3 * width * height);
    converted = read_rgb(*frame, line, out.rgb8.data(), 3 * width);
  } else {
    FrameConverter converter(PixelFormat::kRgb24);
    ConvertedFrame rgb;
    converted = converter.convert(*frame, rgb).ok();
    out.rgb8.resize(3 * width * height);
    for (std::size_t y = 0; converted && y < height; ++y) {
      std::copy_n(rgb.bytes.data() + y * rgb.view.stride_bytes[0], 3 * width, out.rgb8.data() + 3 * width * y);
    }
  }
  if (converted) return out;
  return failure(ErrorCode::kUnsupported, "%s: layout %s or size cannot be converted to RGB", path.c_str(),
                 layout == nullptr ? "unknown" : layout->name);
}

Result<std::string> encode_png(const Picture& picture) {
  const std::size_t values = std::size_t{3} * picture.width_px * picture.height_px;
  const bool is_16_bit = picture.is_16_bit();
  if (values == 0 || (is_16_bit ? picture.rgb16.size() : picture.rgb8.size()) != values ||
      (is_16_bit && !picture.rgb8.empty())) {
    return failure(ErrorCode::kOutOfRange, "the number of values does not match the picture's size");
  }
  const LogCapture log;
  const AVCodec* encoder = avcodec_find_encoder(AV_CODEC_ID_PNG);
  CodecPtr codec(encoder == nullptr ? nullptr : avcodec_alloc_context3(encoder));
  if (codec == nullptr) return failure(ErrorCode::kUnsupported, "this FFmpeg has no PNG encoder");
  FramePtr frame(av_frame_alloc());
  PacketPtr packet(av_packet_alloc());
  codec->width = frame->width = static_cast<int>(picture.width_px);
  codec->height = frame->height = static_cast<int>(picture.height_px);
  codec->pix_fmt = is_16_bit ? AV_PIX_FMT_RGB48BE : AV_PIX_FMT_RGB24;
  codec->time_base = {1, 1};
  codec->thread_count = 1;
  frame->format = codec->pix_fmt;
  int result = avcodec_open2(codec.get(), encoder, nullptr);
  if (result >= 0) result = av_frame_get_buffer(frame.get(), 0);
  if (result >= 0) {
    const std::size_t row_values = std::size_t{3} * picture.width_px;
    for (std::size_t y = 0; y < picture.height_px; ++y) {
      std::uint8_t* row = frame->data[0] + static_cast<std::ptrdiff_t>(y) * frame->linesize[0];
      for (std::size_t i = 0; i < row_values; ++i) {
        if (is_16_bit) {
          const std::uint16_t value = picture.rgb16[y * row_values + i];
          row[2 * i] = static_cast<std::uint8_t>(value >> 8);
          row[2 * i + 1] = static_cast<std::uint8_t>(value & 0xff);
        } else {
          row[i] = picture.rgb8[y * row_values + i];
        }
      }
    }
    result = avcodec_send_frame(codec.get(), frame.get());
  }
  if (result >= 0) result = avcodec_receive_packet(codec.get(), packet.get());
  if (result < 0) return Error{ErrorCode::kIo, log.first_error().empty() ? error_text(result) : log.first_error()};
  return std::string(reinterpret_cast<const char*>(packet->data), static_cast<std::size_t>(packet->size));
}

Result<void> write_picture(const std::string& path, const Picture& picture, const OutputOptions& options) {
  Result<std::string> png = encode_png(picture);
  if (!png.ok()) return prefixed(path, std::move(png).error());
  return write_file(path, png.value(), options);
}

}  // namespace touchline::hal
