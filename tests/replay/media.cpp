#include "tests/replay/media.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "hal/replay/ffmpeg.h"
#include "tests/results.h"

namespace touchline::media {

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "touchline-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}
Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

hal::Picture colorful(std::uint32_t width_px, std::uint32_t height_px, std::uint32_t seed) {
  hal::Picture picture{width_px, height_px, {}, {}};
  picture.rgb8.resize(std::size_t{3} * width_px * height_px);
  std::uint32_t state = 12345u + seed;
  for (std::uint8_t& value : picture.rgb8) {
    state = state * 1664525u + 1013904223u;
    value = static_cast<std::uint8_t>(state >> 24);
  }
  return picture;
}

void write_png(const std::string& path, const hal::Picture& picture) { ASSERT_OK(hal::write_picture(path, picture)); }

void write_jpeg(const std::string& path, const hal::Picture& picture) {
  using namespace hal::ffmpeg;
  const LogCapture log;
  const AVCodec* encoder = avcodec_find_encoder(AV_CODEC_ID_MJPEG);
  ASSERT_NE(encoder, nullptr);
  CodecPtr codec(avcodec_alloc_context3(encoder));
  FramePtr frame(av_frame_alloc());
  PacketPtr packet(av_packet_alloc());
  codec->width = frame->width = static_cast<int>(picture.width_px);
  codec->height = frame->height = static_cast<int>(picture.height_px);
  codec->pix_fmt = AV_PIX_FMT_YUVJ420P;
  frame->format = codec->pix_fmt;
  codec->time_base = {1, 1};
  codec->flags |= AV_CODEC_FLAG_QSCALE;
  codec->global_quality = frame->quality = 2 * FF_QP2LAMBDA;
  ASSERT_GE(avcodec_open2(codec.get(), encoder, nullptr), 0);
  ASSERT_GE(av_frame_get_buffer(frame.get(), 0), 0);
  const ScalerPtr scaler(sws_getContext(frame->width, frame->height, AV_PIX_FMT_RGB24, frame->width, frame->height,
                                        AV_PIX_FMT_YUVJ420P, SWS_BILINEAR, nullptr, nullptr, nullptr));
  const std::uint8_t* const data[4] = {picture.rgb8.data(), nullptr, nullptr, nullptr};
  const int stride[4] = {3 * frame->width, 0, 0, 0};
  sws_scale(scaler.get(), data, stride, 0, frame->height, frame->data, frame->linesize);
  ASSERT_GE(avcodec_send_frame(codec.get(), frame.get()), 0);
  ASSERT_GE(avcodec_receive_packet(codec.get(), packet.get()), 0);
  write_bytes(path, {packet->data, static_cast<std::size_t>(packet->size)});
}

void write_y4m(const std::string& path, int width_px, int height_px, const std::string& header,
               const std::vector<std::vector<std::uint8_t>>& frames) {
  std::ofstream file(path, std::ios::binary);
  file << "YUV4MPEG2 W" << width_px << " H" << height_px << ' ' << header << '\n';
  for (const std::vector<std::uint8_t>& planes : frames) {
    file << "FRAME\n";
    file.write(reinterpret_cast<const char*>(planes.data()), static_cast<std::streamsize>(planes.size()));
  }
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

}  // namespace touchline::media
