#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace touchline::radio {

/// Describes the bytes of a packet to the robots, one line for each field: its bytes in hexadecimal, its name, its
/// value. Bytes that are no packet are shown as such.
std::string packet_text(std::span<const std::byte> bytes);
/// The same for bytes from the robots, which may contain several packets, and parts of packets.
std::string telemetry_text(std::span<const std::byte> bytes);

}  // namespace touchline::radio
