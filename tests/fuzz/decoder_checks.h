#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

// What must hold for any bytes that a decoder gets. The fuzz targets and a test with fixed random numbers use it.
namespace touchline::fuzz {

struct DecoderCheck {
  const char* name;
  /// Decodes the bytes. Aborts with a message if the result breaks a promise of the decoder.
  void (*check)(std::span<const std::byte> bytes);
  /// Valid datagrams to start from.
  std::vector<std::string> (*seeds)();
};

/// firasim_packet, json_commands, ssl_referee, vss_referee, client_message, foxglove_client.
std::span<const DecoderCheck> decoder_checks();

}  // namespace touchline::fuzz
