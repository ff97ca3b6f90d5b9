#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/replay/picture.h"
#include "hal/result.h"

// Decoders of still pictures. Private to hal/replay.
namespace touchline::hal {

/// A decoded file. `is_yuv`: rgb8 contains Y, U, V of full range instead of R, G, B.
struct StoredPicture {
  Picture values;
  bool is_yuv = false;
};

/// What becomes of a JPEG that is stored in YUV, as most are.
enum class JpegColors : std::uint8_t {
  kRgb,       // chroma is interpolated at its position, then converted
  kAsStored,  // stays YUV; pixels that share a chroma sample get copies of it
};

/// Decodes one PNG, PNM or JPEG file. Errors as for read_picture().
Result<StoredPicture> decode_picture(const std::string& path, std::int64_t max_pixels, JpegColors colors);

// The decoders of single formats. `bytes` begin with the format's first bytes. Messages do not name the file.
Result<Picture> decode_png(std::string_view bytes, std::int64_t max_pixels);
Result<Picture> decode_pnm(std::string_view bytes, std::int64_t max_pixels);
Result<StoredPicture> decode_jpeg(std::string_view bytes, std::int64_t max_pixels, JpegColors colors);

Error too_many_pixels(std::int64_t max_pixels);
Error damaged(const char* cause);

}  // namespace touchline::hal
