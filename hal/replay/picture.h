#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/files/output_file.h"
#include "hal/result.h"

namespace touchline::hal {

/// A picture in memory: rows without padding, R, G, B interleaved, 3 * width_px * height_px values in one of the two
/// arrays; the other one is empty.
struct Picture {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb8;
  std::vector<std::uint16_t> rgb16;  // each 0 to 65535
  [[nodiscard]] bool is_16_bit() const { return !rgb16.empty(); }
};

/// Largest picture to be read: twice the width and twice the height of the largest frame, because tools draw figures of
/// that size. With 16 bits per channel, reading it takes 240 MB.
inline constexpr std::int64_t kMaxPicturePixels = std::int64_t{4} * kMaxFrameWidth * kMaxFrameHeight;

/// Reads a PNG, PPM/PGM or JPEG file; the format is detected from its first bytes. Pictures of more than 8 bits per
/// channel become rgb16, all others rgb8; alpha is dropped, gray is copied to the three channels. Pictures of more than
/// `max_pixels` are rejected before memory for their pixels is allocated. kNotFound, kPermission, kIo: the file cannot
/// be read; kUnsupported: it is no picture in one of these formats; kOutOfRange: it has too many pixels; kCorruptFrame:
/// it is truncated or damaged, even if the decoder returns the undamaged part. The message names the file and the
/// cause.
Result<Picture> read_picture(const std::string& path, std::int64_t max_pixels = kMaxPicturePixels);

/// Encodes a PNG file with 8 or 16 bits per channel in memory. kOutOfRange: the number of values does not match the
/// size; kUnsupported: FFmpeg has no encoder.
Result<std::string> encode_png(const Picture& picture);

/// Writes a PNG file as OutputFile does. Errors of encode_png() and OutputFile; the message names the file and the
/// cause.
Result<void> write_picture(const std::string& path, const Picture& picture, const OutputOptions& options = {});

}  // namespace touchline::hal
