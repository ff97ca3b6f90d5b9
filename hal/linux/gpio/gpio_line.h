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
  const char* bias_key = "";  // of the board file
  Duration debounce{};
};

struct GpioEdge {
  bool active = false;  // after the edge, after the polarity
  Instant at{};         // CLOCK_MONOTONIC
};

/// One requested line of a GPIO chip, under the name "touchline". Its implementation alone knows the version of
/// libgpiod: gpio_line_v1.cpp or gpio_line_v2.cpp, whichever fits the library that is there when Touchline is built.
class GpioLine {
 public:
  GpioLine();
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine();

  /// The line is low at first. The message of an error names chip, line and cause.
  Result<void> request_output(const std::string& chip, int line);
  /// With edges where the chip can tell them, debounced by the kernel where it does that.
  Result<void> request_input(const std::string& chip, int line, const GpioInput& input);
  void release();
  [[nodiscard]] bool requested() const { return request_ != nullptr; }
  /// Of an input; else it can only be looked at.
  [[nodiscard]] bool tells_edges() const { return tells_edges_; }
  [[nodiscard]] bool debounced() const { return debounced_; }

  // The calls below do not block and return 0 or an errno.
  [[nodiscard]] int set(bool active) const;
  [[nodiscard]] int get(bool& active) const;
  /// The oldest edges that have not been read yet, as many as there are and fit.
  [[nodiscard]] int read_edges(std::span<GpioEdge> edges, std::size_t& count) const;

 private:
  struct Request;
  std::unique_ptr<Request> request_;
  bool tells_edges_ = false, debounced_ = false;
};

}  // namespace touchline::hal
