// libgpiod 1.x
#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "hal/linux/gpio/gpio_line_error.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {

struct GpioLine::Request {
  Request() = default;
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;
  ~Request() {
    if (chip != nullptr) gpiod_chip_close(chip);  // this also releases the chip's lines
  }
  gpiod_chip* chip = nullptr;
  gpiod_line* line = nullptr;
};

namespace {

constexpr const char* kConsumer = "touchline";
int flags_of(const GpioInput& input) {
  const int polarity = input.active_low ? int{GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW} : 0;
  switch (input.bias) {
    case GpioBias::kPullUp:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioBias::kPullDown:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case GpioBias::kNone:
      break;
  }
  return polarity;  // no bias flag, because kernels before 5.5 refuse all bias flags
}

Result<void> find(const std::string& chip, int line, gpiod_chip*& found_chip, gpiod_line*& found_line) {
  found_chip = gpiod_chip_open(chip.c_str());
  if (found_chip == nullptr) {
    const int error = errno;
    return chip_error(chip, error);
  }
  found_line = gpiod_chip_get_line(found_chip, static_cast<unsigned>(line));
  if (found_line != nullptr) return {};
  const int error = errno;
  if (error == EINVAL) {
    return no_such_line(chip, line, gpiod_chip_label(found_chip), gpiod_chip_num_lines(found_chip));
  }
  return failure(use_error(error), "%s line %d: cannot be found: %s", chip.c_str(), line, system_text(error));
}

}  // namespace

GpioLine::GpioLine() = default;
GpioLine::~GpioLine() = default;

Result<void> GpioLine::request_output(const std::string& chip, int line) {
  release();
  auto request = std::make_unique<Request>();
  TOUCHLINE_TRY(find(chip, line, request->chip, request->line));
  if (gpiod_line_request_output(request->line, kConsumer, 0) != 0) {
    const int error = errno;
    return line_error(chip, line, error, gpiod_line_consumer(request->line), nullptr);
  }
  request_ = std::move(request);
  return {};
}

Result<void> GpioLine::request_input(const std::string& chip, int line, const GpioInput& input) {
  release();
  auto request = std::make_unique<Request>();
  TOUCHLINE_TRY(find(chip, line, request->chip, request->line));
  const int flags = flags_of(input);
  has_edge_events_ = gpiod_line_request_both_edges_events_flags(request->line, kConsumer, flags) == 0;
  // A chip without interrupts can still be polled.
  if (!has_edge_events_ && gpiod_line_request_input_flags(request->line, kConsumer, flags) != 0) {
    const int error = errno;
    return line_error(chip, line, error, gpiod_line_consumer(request->line), &input);
  }
  if (has_edge_events_) {
    if (const int error = make_nonblocking(gpiod_line_event_get_fd(request->line)); error != 0) {
      return line_error(chip, line, error, nullptr, &input);
    }
  }
  request_ = std::move(request);
  return {};
}

void GpioLine::release() {
  request_.reset();
  has_edge_events_ = debounced_ = false;
}

int GpioLine::set(bool active) const { return gpiod_line_set_value(request_->line, active ? 1 : 0) == 0 ? 0 : errno; }

int GpioLine::get(bool& active) const {
  const int value = gpiod_line_get_value(request_->line);
  active = value == 1;
  return value < 0 ? errno : 0;
}

int GpioLine::read_edges(std::span<GpioEdge> edges, std::size_t& count) const {
  count = 0;
  std::array<gpiod_line_event, kMaxLineEvents> events{};
  const auto most = static_cast<unsigned>(std::min(events.size(), edges.size()));
  const int read = gpiod_line_event_read_multiple(request_->line, events.data(), most);
  if (read < 0) return errno == EAGAIN ? 0 : errno;
  for (; count < static_cast<std::size_t>(read); ++count) {
    const gpiod_line_event& event = events[count];
    edges[count] = {event.event_type == GPIOD_LINE_EVENT_RISING_EDGE,
                    Instant(std::chrono::seconds(event.ts.tv_sec) + std::chrono::nanoseconds(event.ts.tv_nsec))};
  }
  return 0;
}

}  // namespace touchline::hal
