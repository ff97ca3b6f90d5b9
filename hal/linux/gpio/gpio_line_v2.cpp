// libgpiod 2.x
#include <gpiod.h>

#include <algorithm>
#include <cerrno>

#include "hal/linux/gpio/gpio_line_error.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// Frees objects of the library.
struct Closer {
  void operator()(gpiod_chip* p) const { gpiod_chip_close(p); }
  void operator()(gpiod_chip_info* p) const { gpiod_chip_info_free(p); }
  void operator()(gpiod_line_info* p) const { gpiod_line_info_free(p); }
  void operator()(gpiod_line_settings* p) const { gpiod_line_settings_free(p); }
  void operator()(gpiod_line_config* p) const { gpiod_line_config_free(p); }
  void operator()(gpiod_request_config* p) const { gpiod_request_config_free(p); }
  void operator()(gpiod_line_request* p) const { gpiod_line_request_release(p); }
  void operator()(gpiod_edge_event_buffer* p) const { gpiod_edge_event_buffer_free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Closer>;

constexpr const char* kConsumer = "touchline";
gpiod_line_bias bias_of(GpioBias bias) {
  switch (bias) {
    case GpioBias::kPullUp:
      return GPIOD_LINE_BIAS_PULL_UP;
    case GpioBias::kPullDown:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case GpioBias::kNone:
      break;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

// These setters fail only for values that are not in their enumerations.
Owned<gpiod_line_settings> settings_of(const GpioInput& input, bool with_edges, bool with_debounce) {
  Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
  if (!settings) return settings;
  static_cast<void>(gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT));
  gpiod_line_settings_set_active_low(settings.get(), input.active_low);
  static_cast<void>(gpiod_line_settings_set_bias(settings.get(), bias_of(input.bias)));
  if (with_edges) static_cast<void>(gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH));
  if (with_debounce) {
    const auto period = std::chrono::duration_cast<std::chrono::microseconds>(input.debounce);
    gpiod_line_settings_set_debounce_period_us(settings.get(), static_cast<unsigned long>(period.count()));
  }
  return settings;
}

// Returns null on error, with errno set.
Owned<gpiod_line_request> request_line(gpiod_chip* chip, unsigned line, gpiod_line_settings* settings) {
  const Owned<gpiod_line_config> lines(gpiod_line_config_new());
  const Owned<gpiod_request_config> config(gpiod_request_config_new());
  if (settings == nullptr || !lines || !config) {
    errno = ENOMEM;
    return nullptr;
  }
  gpiod_request_config_set_consumer(config.get(), kConsumer);
  if (gpiod_line_config_add_line_settings(lines.get(), &line, 1, settings) != 0) return nullptr;
  return Owned<gpiod_line_request>(gpiod_chip_request_lines(chip, config.get(), lines.get()));
}

// Opens the chip and checks that it has the line.
Result<void> find(const std::string& path, int line, Owned<gpiod_chip>& chip) {
  chip.reset(gpiod_chip_open(path.c_str()));
  if (!chip) {
    const int error = errno;
    return chip_error(path, error);
  }
  const Owned<gpiod_chip_info> info(gpiod_chip_get_info(chip.get()));
  if (!info) {
    const int error = errno;
    return failure(use_error(error), "%s: reading the chip information failed: %s", path.c_str(), system_text(error));
  }
  const std::size_t lines = gpiod_chip_info_get_num_lines(info.get());
  if (static_cast<std::size_t>(line) < lines) return {};
  return no_such_line(path, line, gpiod_chip_info_get_label(info.get()), lines);
}

Error refused(const std::string& path, gpiod_chip* chip, int line, int error, const GpioInput* input) {
  const Owned<gpiod_line_info> info(gpiod_chip_get_line_info(chip, static_cast<unsigned>(line)));
  const char* const holder = info ? gpiod_line_info_get_consumer(info.get()) : nullptr;
  return line_error(path, line, error, holder, input);
}

}  // namespace

struct GpioLine::Request {
  Owned<gpiod_line_request> lines;
  unsigned offset = 0;
  Owned<gpiod_edge_event_buffer> events;
};

GpioLine::GpioLine() = default;
GpioLine::~GpioLine() = default;

Result<void> GpioLine::request_output(const std::string& chip, int line) {
  release();
  Owned<gpiod_chip> opened;
  TOUCHLINE_TRY(find(chip, line, opened));
  const Owned<gpiod_line_settings> settings(gpiod_line_settings_new());
  if (settings) {
    static_cast<void>(gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT));
    static_cast<void>(gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE));
  }
  auto request = std::make_unique<Request>();
  request->offset = static_cast<unsigned>(line);
  request->lines = request_line(opened.get(), request->offset, settings.get());
  if (!request->lines) return refused(chip, opened.get(), line, errno, nullptr);
  request_ = std::move(request);
  return {};
}

Result<void> GpioLine::request_input(const std::string& chip, int line, const GpioInput& input) {
  release();
  Owned<gpiod_chip> opened;
  TOUCHLINE_TRY(find(chip, line, opened));
  auto request = std::make_unique<Request>();
  request->offset = static_cast<unsigned>(line);
  const auto ask = [&](bool with_edges, bool with_debounce) {
    const Owned<gpiod_line_settings> settings = settings_of(input, with_edges, with_debounce);
    request->lines = request_line(opened.get(), request->offset, settings.get());
    has_edge_events_ = request->lines && with_edges;
    debounced_ = request->lines && with_debounce;
    return request->lines != nullptr;
  };
  // Kernels before 5.10 do not debounce. A chip without interrupts has no edge events but can be polled.
  const bool debounce = input.debounce > Duration::zero();
  if (!(debounce && ask(true, true)) && !ask(true, false) && !ask(false, false)) {
    return refused(chip, opened.get(), line, errno, &input);
  }
  if (has_edge_events_) {
    request->events.reset(gpiod_edge_event_buffer_new(kMaxLineEvents));
    const int error = request->events ? make_nonblocking(gpiod_line_request_get_fd(request->lines.get())) : ENOMEM;
    if (error != 0) return refused(chip, opened.get(), line, error, &input);
  }
  request_ = std::move(request);
  return {};
}

void GpioLine::release() {
  request_.reset();
  has_edge_events_ = debounced_ = false;
}

int GpioLine::set(bool active) const {
  const gpiod_line_value value = active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  return gpiod_line_request_set_value(request_->lines.get(), request_->offset, value) == 0 ? 0 : errno;
}

int GpioLine::get(bool& active) const {
  const gpiod_line_value value = gpiod_line_request_get_value(request_->lines.get(), request_->offset);
  active = value == GPIOD_LINE_VALUE_ACTIVE;
  return value == GPIOD_LINE_VALUE_ERROR ? errno : 0;
}

int GpioLine::read_edges(std::span<GpioEdge> edges, std::size_t& count) const {
  count = 0;
  gpiod_edge_event_buffer* const events = request_->events.get();
  const std::size_t most = std::min(kMaxLineEvents, edges.size());
  const int read = gpiod_line_request_read_edge_events(request_->lines.get(), events, most);
  if (read < 0) return errno == EAGAIN ? 0 : errno;
  for (; count < static_cast<std::size_t>(read); ++count) {
    gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(events, count);
    const auto at = std::chrono::nanoseconds(gpiod_edge_event_get_timestamp_ns(event));
    edges[count] = {gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE, Instant(at)};
  }
  return 0;
}

}  // namespace touchline::hal
