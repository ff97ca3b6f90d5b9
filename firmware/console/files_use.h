#pragma once

#include <cstdint>
#include <functional>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::console {

/// Says when the files that the setup program has ordered are in use.
enum class FilesUse : std::uint8_t {
  kAtOnce,         // the running session has adopted them
  kInNextSession,  // another session with them follows this one
};

/// Loads these files, or the saved ones if they are empty. Called on a FileThread, whose rules for jobs hold.
using UseFiles = std::function<Result<FilesUse>(const config::FilePaths& draft)>;

}  // namespace touchline::console
