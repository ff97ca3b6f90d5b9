#pragma once

#include <string>

#include "firmware/console/foxglove_client.h"

namespace touchline::console {

/// Where a channel is found and what its messages look like.
struct FoxgloveSchema {
  std::string_view topic, name;
  std::string text;  // JSON schema of the members that are sent
};
FoxgloveSchema foxglove_schema(FoxgloveChannel channel);

}  // namespace touchline::console
