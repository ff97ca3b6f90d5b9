#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace touchline::testing {

/// Variants of the JPEG pictures that cameras send.
struct JpegStyle {
  unsigned width = 320, height = 240;
  int horizontal = 2, vertical = 1;  // number of pixels that share a chroma sample, in each direction
  bool gray = false, rgb = false, progressive = false;
  bool own_huffman_tables = false;  // Huffman tables are computed for this picture
  bool with_huffman_tables = true;  // false: the standard tables are omitted, as many cameras do
  bool with_restarts = false;       // there is a marker after each row of blocks
};

/// Returns a picture of four quarters: red, green, blue, white, all at full brightness; the first 8 x 8 pixels are
/// black.
std::vector<std::uint8_t> jpeg_of(const JpegStyle& style = {});

/// Returns R, G, B of the picture at a pixel.
std::array<int, 3> color_at(const JpegStyle& style, unsigned u, unsigned v);

}  // namespace touchline::testing
