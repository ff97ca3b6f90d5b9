#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/result.h"

namespace touchline::hal {

struct GpioInput {
  bool active_low = false;
  GpioBias bias = GpioBias::kNone;
  const char* bias_key = "";  // key of the board file that sets the bias, for messages
  Duration debounce{};
};

struct GpioEdge {
  bool active = false;  // level after the edge, with the polarity applied
  Instant at{};         // time of CLOCK_MONOTONIC
};

// Size of the kernel's event buffer of a line.
inline constexpr std::size_t kMaxLineEvents = 16;

/// One requested line of a GPIO chip, with consumer name "touchline". Only its implementation depends on the version of
/// libgpiod: gpio_line_v1.cpp or gpio_line_v2.cpp, chosen by the installed library at build time.
class GpioLine {
 public:
  GpioLine();
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine();

  /// Requests an output, which starts low. Error messages name chip, line and cause.
  Result<void> request_output(const std::string& chip, int line);
  /// Requests edge events if the chip supports them, and debouncing if the kernel supports it.
  Result<void> request_input(const std::string& chip, int line, const GpioInput& input);
  void release();
  [[nodiscard]] bool requested() const { return request_ != nullptr; }
  /// Returns false if an input must be polled.
  [[nodiscard]] bool has_edge_events() const { return has_edge_events_; }
  [[nodiscard]] bool debounced() const { return debounced_; }

  // The functions below do not block, and return 0 or an errno.
  [[nodiscard]] int set(bool active) const;
  [[nodiscard]] int get(bool& active) const;
  /// Reads the oldest unread edges, as many as fit into `edges`.
  [[nodiscard]] int read_edges(std::span<GpioEdge> edges, std::size_t& count) const;

 private:
  struct Request;
  std::unique_ptr<Request> request_;
  bool has_edge_events_ = false, debounced_ = false;
};

}  // namespace touchline::hal
