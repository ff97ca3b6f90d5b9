#pragma once

#include <optional>

#include "firmware/config/configuration.h"
#include "hal/linux/network/network_address.h"
#include "hal/linux/network/tcp_socket.h"
#include "hal/result.h"

namespace touchline {

/// Returns the address of a camera that is another program (camera.backend = "remote"). kInconsistent: the address
/// cannot be used, or in lock-step another device would have a time of its own; the message has the line of the key.
Result<hal::TcpAddress> plan_remote(const config::Configuration& configuration);

/// Returns where the arena that sends the pictures takes requests (camera.control); empty: nowhere. kInconsistent: the
/// message has the line of the key.
Result<std::optional<hal::NetworkAddress>> plan_arena_control(const config::Configuration& configuration);

}  // namespace touchline
