#pragma once

#include <string>

#include "hal/result.h"

namespace touchline::calibrate {

/// Returns the code of a result and stores its message in `text`.
inline ErrorCode code_of(const Result<void>& result, std::string& text) {
  text = result.text();
  return result.code();
}

}  // namespace touchline::calibrate
