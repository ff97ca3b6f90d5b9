#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "hal/result.h"

// Requirements that a decoder must meet for any bytes. The fuzz targets and a test with fixed random numbers use it.
namespace touchline::fuzz {

struct DecoderCheck {
  const char* name;
  /// Decodes the bytes. Aborts with a message if the result breaks a promise of the decoder.
  void (*check)(std::span<const std::byte> bytes);
  /// Returns valid inputs to start from.
  std::vector<std::string> (*seeds)();
  /// Number of damaged inputs in the short test; decoders that take longer get fewer.
  int inputs = 20000;
};

/// Returns all checks. tests/fuzz/CMakeLists.txt names them in the same order.
std::span<const DecoderCheck> decoder_checks();

/// Aborts with a message that names the promise.
void require(bool condition, const char* promise);
/// An error must have a code and a printable text of one line.
void require_error(const Error& error);
template <class T>
void require_result(const Result<T>& result) {
  if (!result.ok()) require_error(result.error());
}

// Of tests/fuzz/file_checks.cpp, tests/fuzz/stream_checks.cpp and tests/fuzz/robot_checks.cpp.
void check_board_file(std::span<const std::byte> bytes);
void check_venue_file(std::span<const std::byte> bytes);
void check_team_file(std::span<const std::byte> bytes);
std::vector<std::string> board_file_seeds();
std::vector<std::string> venue_file_seeds();
std::vector<std::string> team_file_seeds();
void check_mjpg(std::span<const std::byte> bytes);
void check_telemetry(std::span<const std::byte> bytes);
void check_command_packet(std::span<const std::byte> bytes);
void check_setup_message(std::span<const std::byte> bytes);
void check_lockstep_message(std::span<const std::byte> bytes);
void check_robot(std::span<const std::byte> bytes);
std::vector<std::string> mjpg_seeds();
std::vector<std::string> telemetry_seeds();
std::vector<std::string> command_packet_seeds();
std::vector<std::string> setup_message_seeds();
std::vector<std::string> lockstep_message_seeds();
std::vector<std::string> robot_seeds();

}  // namespace touchline::fuzz
