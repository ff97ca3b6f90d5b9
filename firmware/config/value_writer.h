#pragma once

#include <string>
#include <string_view>

#include "hal/result.h"

namespace touchline::config {

/// Returns the text of a TOML file with one value replaced, added, or removed if `value` is empty. Everything else
/// stays unchanged: order, line ends, comments, and their columns if possible. `table`: "camera", "camera_model.full"
/// or "color[0]"; "": the keys before the first header. `value` is TOML: "2.5", "\"rgb24\"", "[1, 2]".
///
/// kInconsistent: the text or the value is not valid TOML, or the table is not written with a header.
Result<std::string> replace_value(const std::string& text, const std::string& table, const std::string& key,
                                  const std::string& value);

}  // namespace touchline::config
