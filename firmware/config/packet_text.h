#pragma once

#include <span>
#include <string>

#include "core/radio/packet_layout.h"
#include "firmware/config/configuration.h"

namespace touchline::config {

/// Explains the bytes of a packet: a line for each field with its bytes, name and value. Bytes that are not a packet of
/// the layout are printed with the word "unknown". `bytes` are without framing.
std::string packet_text(const PacketLayout& layout, std::span<const std::byte> bytes);

/// The same for bytes from a line, which may contain several packets and parts of packets.
std::string received_text(const PacketLayout& layout, std::span<const std::byte> bytes);

/// A sample of the packets that the team's robots would get: all drive at 0.5 m/s and turn at 1 rad/s. With framing,
/// its bytes on the line stand before the fields.
std::string sample_packet_text(const PipelineParameters& parameters);

/// Warnings about the robots' packets, a line each: a packet takes longer on the line than a frame, robots have no
/// time-out of their own, packets have no team number, and the note of the preset.
std::string radio_warnings(const Configuration& configuration);

/// The formats that radio.format can name, or the keys of the format `name` as a section of a team file. kNotFound:
/// there is no such format.
Result<std::string> radio_formats_text(const std::string& name);

}  // namespace touchline::config
