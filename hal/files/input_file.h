#pragma once

#include <cstddef>
#include <string>

#include "hal/result.h"

namespace touchline::hal {

/// Size of the largest configuration file that is read. A venue of 32 color boxes has about 10 KB.
inline constexpr std::size_t kMaxTextFileBytes = std::size_t{1} << 20;
/// Size of the largest picture or JSON file that is read. A PNG of 12000 x 9000 pixels with 16 bits per channel has up
/// to 600 MB; cameras deliver up to 5 megapixels.
inline constexpr std::size_t kMaxDataFileBytes = std::size_t{256} << 20;

/// Reads a whole regular file of at most `limit_bytes`. It never waits: a FIFO or a device is rejected, not read.
/// kNotFound, kPermission, kIo: as usual; kOutOfRange: the file is larger than the limit; kUnsupported: it is not a
/// regular file. The message names the file and the cause.
Result<std::string> read_file(const std::string& path, std::size_t limit_bytes);

}  // namespace touchline::hal
