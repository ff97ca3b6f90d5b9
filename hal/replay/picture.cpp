#include "hal/replay/picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>

#include "core/types.h"
#include "hal/replay/frame_converter.h"
#include "hal/replay/picture_decoder.h"

namespace touchline::hal {
namespace {

using namespace ffmpeg;

ErrorCode code_of_errno(int error) {
  if (error == ENOENT || error == ENOTDIR) return ErrorCode::kNotFound;
  if (error == EACCES || error == EPERM) return ErrorCode::kPermission;
  return ErrorCode::kIo;
}

Status read_file(const std::string& path, std::vector<std::uint8_t>& bytes, std::string& reason) {
  errno = 0;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    reason = path + ": is a folder, not a picture";
    return ErrorCode::kIo;
  }
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) {
    const int cause = errno;
    reason = path + ": " + std::strerror(cause == 0 ? EIO : cause);
    return code_of_errno(cause);
  }
  const auto size = static_cast<std::size_t>(file.tellg());
  bytes.assign(size + AV_INPUT_BUFFER_PADDING_SIZE, 0);
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) {
    reason = path + ": cannot be read";
    return ErrorCode::kIo;
  }
  bytes.resize(size);  // the padding stays allocated behind the end
  return {};
}

AVCodecID kind_of(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 8> kPng{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const auto begins = [bytes](std::span<const std::uint8_t> magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (begins(kPng)) return AV_CODEC_ID_PNG;
  if (begins(std::array<std::uint8_t, 3>{0xff, 0xd8, 0xff})) return AV_CODEC_ID_MJPEG;
  if (bytes.size() > 2 && bytes[0] == 'P') {
    if (bytes[1] == '6' || bytes[1] == '3') return AV_CODEC_ID_PPM;
    if (bytes[1] == '5' || bytes[1] == '2') return AV_CODEC_ID_PGM;
  }
  return AV_CODEC_ID_NONE;
}

}  // namespace

namespace ffmpeg {

Status decode_picture(const std::string& path, FramePtr& out, std::string& reason) {
  std::vector<std::uint8_t> bytes;
  if (Status s = read_file(path, bytes, reason); !s.ok()) return s;
  if (bytes.empty()) {
    reason = path + ": the file is empty";
    return ErrorCode::kCorruptFrame;
  }
  const AVCodecID kind = kind_of(bytes);
  const AVCodec* decoder = kind == AV_CODEC_ID_NONE ? nullptr : avcodec_find_decoder(kind);
  if (decoder == nullptr) {
    reason = path + ": is no PNG, PPM or JPEG picture";
    return ErrorCode::kUnsupported;
  }
  const LogCapture log;
  CodecPtr codec(avcodec_alloc_context3(decoder));
  PacketPtr packet(av_packet_alloc());
  out.reset(av_frame_alloc());
  // Damage must be an error: FFmpeg would hand out what it could decode and log a line.
  codec->err_recognition = AV_EF_CRCCHECK | AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
  codec->thread_count = 1;
  int result = avcodec_open2(codec.get(), decoder, nullptr);
  packet->data = bytes.data();
  packet->size = static_cast<int>(bytes.size());
  if (result >= 0) result = avcodec_send_packet(codec.get(), packet.get());
  if (result >= 0) result = avcodec_send_packet(codec.get(), nullptr);
  if (result >= 0) result = avcodec_receive_frame(codec.get(), out.get());
  // A cut JPEG is only warned of ("EOI missing, emulating").
  const std::string& complaint = log.first_error().empty() ? log.first_warning() : log.first_error();
  const bool damaged = !log.first_error().empty() || (kind == AV_CODEC_ID_MJPEG && !log.first_warning().empty());
  if (result < 0 || damaged || out->decode_error_flags != 0 || (out->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
    out.reset();
    reason = path + ": truncated or damaged (" + (complaint.empty() ? error_text(result) : complaint) + ")";
    return ErrorCode::kCorruptFrame;
  }
  return {};
}

}  // namespace ffmpeg

Status read_picture(const std::string& path, Picture& out, std::string& reason) {
  FramePtr frame;
  if (Status s = decode_picture(path, frame, reason); !s.ok()) return s;
  const auto width = static_cast<std::size_t>(frame->width), height = static_cast<std::size_t>(frame->height);
  out = {};
  out.width_px = static_cast<std::uint32_t>(width);
  out.height_px = static_cast<std::uint32_t>(height);
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame->format));
  std::vector<std::uint16_t> line;
  Status status;
  if (stored_as_rgb(*frame) && layout->comp[0].depth > 8) {
    out.rgb16.resize(3 * width * height);
    status = read_rgb(*frame, line, out.rgb16.data(), 3 * width);
  } else if (stored_as_rgb(*frame)) {
    out.rgb8.resize(3 * width * height);
    status = read_rgb(*frame, line, out.rgb8.data(), 3 * width);
  } else {
    FrameConverter converter(PixelFormat::kRgb24);
    ConvertedFrame converted;
    status = converter.convert(*frame, converted);
    out.rgb8.resize(3 * width * height);
    for (std::size_t y = 0; status.ok() && y < height; ++y) {
      std::copy_n(converted.bytes.data() + y * converted.view.stride_bytes[0], 3 * width,
                  out.rgb8.data() + 3 * width * y);
    }
  }
  if (!status.ok()) {
    out = {};
    const char* name = layout == nullptr ? "unknown" : layout->name;
    reason = path + ": layout " + name + " or size cannot be converted to RGB";
  }
  return status;
}

Status write_picture(const std::string& path, const Picture& picture, std::string& reason) {
  const std::size_t values = std::size_t{3} * picture.width_px * picture.height_px;
  const bool deep = picture.deep();
  if (values == 0 || (deep ? picture.rgb16.size() : picture.rgb8.size()) != values || (deep && !picture.rgb8.empty())) {
    reason = path + ": the picture's size does not fit to its values";
    return ErrorCode::kOutOfRange;
  }
  const LogCapture log;
  const AVCodec* encoder = avcodec_find_encoder(AV_CODEC_ID_PNG);
  CodecPtr codec(encoder == nullptr ? nullptr : avcodec_alloc_context3(encoder));
  if (codec == nullptr) {
    reason = path + ": this FFmpeg has no PNG encoder";
    return ErrorCode::kUnsupported;
  }
  FramePtr frame(av_frame_alloc());
  PacketPtr packet(av_packet_alloc());
  codec->width = frame->width = static_cast<int>(picture.width_px);
  codec->height = frame->height = static_cast<int>(picture.height_px);
  codec->pix_fmt = deep ? AV_PIX_FMT_RGB48BE : AV_PIX_FMT_RGB24;
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
        if (deep) {
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
  if (result < 0) {
    reason = path + ": " + (log.first_error().empty() ? error_text(result) : log.first_error());
    return ErrorCode::kIo;
  }
  const std::string part = path + ".part";
  errno = 0;
  std::ofstream file(part, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(packet->data), packet->size);
  file.close();
  if (!file || std::rename(part.c_str(), path.c_str()) != 0) {
    const int cause = errno;
    reason = path + ": " + std::strerror(cause == 0 ? EIO : cause);
    std::remove(part.c_str());
    return code_of_errno(cause);
  }
  return {};
}

}  // namespace touchline::hal
