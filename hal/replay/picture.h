#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/status.h"
#include "hal/linux/files/output_file.h"

namespace touchline::hal {

/// A picture in memory: rows without gaps, R, G, B interleaved, 3 * width_px * height_px values in the one of the two
/// arrays that is not empty.
struct Picture {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb8;
  std::vector<std::uint16_t> rgb16;  // 0 to 65535
  [[nodiscard]] bool deep() const { return !rgb16.empty(); }
};

/// Reads a PNG, PPM/PGM or JPEG file; its kind is told from its first bytes. Pictures of more than 8 bits a channel
/// come as rgb16, all others as rgb8; alpha is dropped, grey is repeated in the three channels. kNotFound, kPermission,
/// kIo: the file; kUnsupported: no such picture; kCorruptFrame: truncated or damaged, also where a decoder would
/// deliver the undamaged part. `reason` then names the file and the cause.
Status read_picture(const std::string& path, Picture& out, std::string& reason);

/// A PNG file of 8 or 16 bits a channel, in memory. kOutOfRange: sizes and values do not fit together; kUnsupported: no
/// encoder. `reason` then has the cause.
Status encode_png(const Picture& picture, std::string& png, std::string& reason);

/// Writes a PNG file by an OutputFile. Errors of encode_png() and OutputFile; `reason` names the file and the cause.
Status write_picture(const std::string& path, const Picture& picture, std::string& reason,
                     const OutputOptions& options = {});

}  // namespace touchline::hal
