#include "tests/replay/media.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

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

void write_jpeg(const std::string& path, const hal::Picture& picture, JpegKind kind) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = picture.width_px;
  jpeg.image_height = picture.height_px;
  const std::size_t channels = kind == JpegKind::kCmyk ? 4 : 3;
  jpeg.input_components = static_cast<int>(channels);
  jpeg.in_color_space = kind == JpegKind::kCmyk ? JCS_CMYK : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  if (kind == JpegKind::k422) jpeg.comp_info[0].v_samp_factor = 1;
  if (kind == JpegKind::kGray) jpeg_set_colorspace(&jpeg, JCS_GRAYSCALE);
  if (kind == JpegKind::kProgressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  for (std::size_t y = 0; y < picture.height_px; ++y) {
    std::vector<std::uint8_t> row(picture.width_px * channels, 0);
    for (std::size_t x = 0; x < picture.width_px; ++x) {
      std::copy_n(&picture.rgb8[3 * (y * picture.width_px + x)], 3, &row[x * channels]);
    }
    JSAMPROW samples = row.data();
    jpeg_write_scanlines(&jpeg, &samples, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  write_bytes(path, {bytes, size});
  std::free(bytes);
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
