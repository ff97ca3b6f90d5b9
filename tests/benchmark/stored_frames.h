#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/result.h"

namespace touchline::testing {

/// The bytes of a frame as a camera delivers them: planes without padding, or a JPEG.
struct StoredFrame {
  Instant capture_time{};
  std::string bytes;
};

/// Frames in a file of this machine's byte order. Errors of hal::write_file().
Result<void> write_frames(const std::string& path, const std::vector<StoredFrame>& frames);
/// Errors of hal::read_file(). kInconsistent: the file ends within a frame.
Result<std::vector<StoredFrame>> read_frames(const std::string& path);

}  // namespace touchline::testing
