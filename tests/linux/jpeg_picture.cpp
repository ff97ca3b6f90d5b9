#include "tests/linux/jpeg_picture.h"

#include "tests/linux/jpeg_encoder.h"

namespace touchline::testing {

std::array<int, 3> color_at(const JpegStyle& style, unsigned u, unsigned v) {
  if (u < 8 && v < 8) return {0, 0, 0};
  const bool right = u >= style.width / 2, low = v >= style.height / 2;
  if (style.gray) return right == low ? std::array{255, 255, 255} : std::array{128, 128, 128};
  if (right && low) return {255, 255, 255};
  return {right || low ? 0 : 255, right ? 255 : 0, low ? 255 : 0};
}

std::vector<std::uint8_t> jpeg_of(const JpegStyle& style) {
  const auto set_up = [&style](jpeg_compress_struct& jpeg) {
    if (style.gray) jpeg_set_colorspace(&jpeg, JCS_GRAYSCALE);
    if (style.rgb) jpeg_set_colorspace(&jpeg, JCS_RGB);
    jpeg_set_quality(&jpeg, 95, TRUE);
    if (!style.gray) {
      jpeg.comp_info[0].h_samp_factor = style.horizontal;
      jpeg.comp_info[0].v_samp_factor = style.vertical;
    }
    jpeg.optimize_coding = style.own_huffman_tables ? TRUE : FALSE;
    jpeg.restart_in_rows = style.with_restarts ? 1 : 0;
    if (style.progressive) jpeg_simple_progression(&jpeg);
  };
  const auto fill_row = [&style](unsigned v, std::span<std::uint8_t> row) {
    for (unsigned u = 0; u < style.width; ++u) {
      const std::array<int, 3> color = color_at(style, u, v);
      for (std::size_t c = 0; c < 3; ++c) row[3 * u + c] = static_cast<std::uint8_t>(color[c]);
    }
  };
  std::vector<std::uint8_t> bytes = encode_jpeg(style.width, style.height, set_up, fill_row);
  if (style.with_huffman_tables) return bytes;
  // Removes the segments with marker DHT (Huffman tables), each with a length of two bytes, before the picture's data.
  for (std::size_t i = 2; bytes[i + 1] != 0xda;) {
    const std::size_t length = 2u + 256u * bytes[i + 2] + bytes[i + 3];
    if (bytes[i + 1] != 0xc4) {
      i += length;
      continue;
    }
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(i);
    bytes.erase(begin, begin + static_cast<std::ptrdiff_t>(length));
  }
  return bytes;
}

}  // namespace touchline::testing
