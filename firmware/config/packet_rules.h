#pragma once

#include <string>

#include "core/radio/packet_layout.h"
#include "firmware/config/error_list.h"
#include "firmware/config/locations.h"

namespace touchline::config {

/// Refuses fields whose numbers cannot be sent as they are, or that robots and Touchline would read differently. `list`
/// is their key in the team file.
void check_fields(const PacketLayout& layout, const std::string& list, const Locations& where, ErrorList& errors);

/// Refuses packets that cannot stop each robot, drive it both ways, or name it and no other one.
void check_robots(const PacketLayout& layout, const std::string& list, const Locations& where, ErrorList& errors);

/// Refuses reports whose id or address is not that of one robot.
void check_telemetry(const PacketLayout& layout, const std::string& list, const Locations& where, ErrorList& errors);

}  // namespace touchline::config
