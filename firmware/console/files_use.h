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

/// Loads these files, or the saved ones if they are empty. The session that is to use them has the number `order` in
/// its Scene, so that another session that begins meanwhile, such as the one of a camera that has appeared, is not
/// taken for it. Called on a FileThread, whose rules for jobs hold.
using UseFiles = std::function<Result<FilesUse>(const config::FilePaths& draft, std::uint64_t order)>;

}  // namespace touchline::console
