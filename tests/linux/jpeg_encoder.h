#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

namespace touchline::testing {

/// Compresses an RGB picture with libjpeg. `set_up(jpeg)` changes the defaults; it also calls jpeg_set_quality().
/// `fill_row(v, row)` writes the 3 * width bytes of row v. `write_all_tables`: as for jpeg_start_compress().
template <class SetUp, class FillRow>
std::vector<std::uint8_t> encode_jpeg(unsigned width, unsigned height, SetUp&& set_up, FillRow&& fill_row,
                                      bool write_all_tables = true) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  set_up(jpeg);
  jpeg_start_compress(&jpeg, write_all_tables ? TRUE : FALSE);
  std::vector<std::uint8_t> row(3 * std::size_t{width});
  while (jpeg.next_scanline < jpeg.image_height) {
    fill_row(jpeg.next_scanline, std::span<std::uint8_t>(row));
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::vector<std::uint8_t> bytes(memory, memory + size);
  std::free(memory);
  return bytes;
}

}  // namespace touchline::testing
