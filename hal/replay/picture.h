#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/types.h"
#include "hal/files/output_file.h"

namespace touchline::hal {

/// A picture in memory: rows without padding, R, G, B interleaved, 3 * width_px * height_px values in one of the two
/// arrays; the other one is empty.
struct Picture {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb8;
  std::vector<std::uint16_t> rgb16;  // 0 to 65535
  [[nodiscard]] bool deep() const { return !rgb16.empty(); }
};

/// Pictures that are read are at most twice as wide and twice as high as the largest frame: tools draw figures of that
/// size. One of 16 bits a channel then takes 240 MB while it is read.
inline constexpr std::int64_t kMaxPicturePixels = std::int64_t{4} * kMaxFrameWidth * kMaxFrameHeight;

/// Reads a PNG, PPM/PGM or JPEG file; the format is detected from its first bytes. Pictures of more than 8 bits a
/// channel become rgb16, all others rgb8; alpha is dropped, gray is copied to the three channels. Pictures of more than
/// `max_pixels` are refused before memory for their pixels is allocated.
/// kNotFound, kPermission, kIo: the file; kUnsupported: not such a picture; kOutOfRange: too many pixels;
/// kCorruptFrame: truncated or damaged, even if a decoder could deliver the undamaged part. `reason` then names the
/// file and the cause.
Status read_picture(const std::string& path, Picture& out, std::string& reason,
                    std::int64_t max_pixels = kMaxPicturePixels);

/// A PNG file of 8 or 16 bits a channel, in memory. kOutOfRange: the number of values does not match the size;
/// kUnsupported: no encoder. `reason` then has the cause.
Status encode_png(const Picture& picture, std::string& png, std::string& reason);

/// Writes a PNG file by an OutputFile. Errors of encode_png() and OutputFile; `reason` names the file and the cause.
Status write_picture(const std::string& path, const Picture& picture, std::string& reason,
                     const OutputOptions& options = {});

}  // namespace touchline::hal
