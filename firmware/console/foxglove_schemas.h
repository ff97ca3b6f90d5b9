#pragma once

#include <string>

#include "firmware/console/foxglove_client.h"

namespace touchline::console {

/// Name of a channel and schema of its messages.
struct FoxgloveSchema {
  std::string_view topic, name;
  std::string text;  // JSON schema of the members that are sent
};
FoxgloveSchema foxglove_schema(FoxgloveChannel channel);

}  // namespace touchline::console
