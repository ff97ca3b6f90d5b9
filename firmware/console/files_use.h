#pragma once

#include <cstdint>
#include <functional>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::console {

/// When the files that the setup program has ordered are used.
enum class FilesUse : std::uint8_t {
  kAtOnce,         // the running session has adopted the files
  kInNextSession,  // the next session will use the files
};

/// Loads these files, or the saved ones if they are empty. It is called on a FileThread, so the rules for its jobs
/// apply.
using UseFiles = std::function<Result<FilesUse>(const config::FilePaths& draft)>;

}  // namespace touchline::console
