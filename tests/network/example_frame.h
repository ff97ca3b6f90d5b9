#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "firmware/network/messages.h"
#include "firmware/network/ssl_vision.h"
#include "firmware/report/trace_json.h"

// Frames with everything that the protocols publish: known and unknown robots of both teams, seen and predicted ones,
// commands and telemetry.
namespace touchline::network {

Snapshot example_snapshot();
/// Returns a snapshot in which all lists are full, and all values have as many digits as possible.
Snapshot fullest_snapshot();

/// Returns a frame in which the own team is blue.
OutputFrame example_output(const Snapshot& snapshot);

/// Returns the mock board's field and a camera above it.
VenueGeometry example_geometry();

inline const report::TraceNames kExampleNames{{"background", "orange", "blue", "yellow", "red"}, {"blue", "yellow"}};

inline const FieldParameters kExampleField{
    .length_m = 2.2f, .width_m = 1.8f, .goal_width_m = 0.4f, .goal_depth_m = 0.15f};

/// Calls `encode` with memory for the largest datagram and returns the bytes.
template <class Encode>
std::string datagram(Encode encode) {
  std::vector<std::byte> memory(kMaxDatagramBytes);
  const std::size_t size = encode(std::span<std::byte>(memory));
  return {reinterpret_cast<const char*>(memory.data()), size};
}

inline std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span<const char>(text.data(), text.size()));
}

}  // namespace touchline::network
