#include "tools/programs/latency/led_watch.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace touchline::latency {

void LedBlinker::attach(hal::Gpio& gpio, hal::Clock& clock) {
  gpio_ = &gpio;
  clock_ = &clock;
}

void LedBlinker::start(double rate_hz) {
  const Duration period = from_seconds(1.0 / rate_hz);
  thread_ = std::jthread([this, period](const std::stop_token& stop) { run(period, stop); });
}

void LedBlinker::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void LedBlinker::run(Duration period, const std::stop_token& stop) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> periods(10.0, 11.0);
  for (bool on = true; !stop.stop_requested(); on = !on) {
    const Instant due = clock_->now() + from_seconds(periods(random) * seconds(period));
    // In the arena, the clock may stand still in between.
    while (clock_->now() < due && !stop.stop_requested()) clock_->sleep_until(due);
    const std::scoped_lock lock(mutex_);
    const Instant before = clock_->now();
    const Result<void> set = gpio_->set_status_led(on);
    const Instant after = clock_->now();
    if (!set.ok()) {
      error_ = set.text();
      return;
    }
    edges_.push_back({before + (after - before) / 2, on, std::chrono::abs(after - before) / 2});
  }
}

Result<void> LedBlinker::do_open() {
  const std::scoped_lock lock(mutex_);
  return gpio_->open();
}
void LedBlinker::do_close() {
  const std::scoped_lock lock(mutex_);
  gpio_->close();
}
Result<void> LedBlinker::do_set_strobe(bool high) {
  const std::scoped_lock lock(mutex_);
  return gpio_->set_strobe(high);
}
Result<hal::GpioInputs> LedBlinker::do_inputs(Instant now) {
  const std::scoped_lock lock(mutex_);
  return gpio_->inputs(now);
}

LedWatch::LedWatch(const LedPlace& place, std::size_t frames) : place_(place), frames_(frames) {}

void LedWatch::add(const Frame& frame, Instant sent) {
  if (count_ == frames_.size()) return;
  const auto range = [&](double center, std::uint16_t size) {
    const double last = size - 1.0;
    return std::pair(static_cast<std::size_t>(std::clamp(std::ceil(center - place_.radius_px), 0.0, last)),
                     static_cast<std::size_t>(std::clamp(std::floor(center + place_.radius_px), 0.0, last)));
  };
  const auto [left, right] = range(place_.u_px, frame.width_px);
  const auto [top, bottom] = range(place_.v_px, frame.height_px);
  // Brightness is Y, or the mean of R, G and B.
  const std::size_t channels = is_yuv(color_space(frame.format)) ? 1 : 3;
  double sum = 0.0, number = 0.0;
  for (std::size_t v = top; v <= bottom; ++v) {
    for (std::size_t u = left; u <= right; ++u) {
      const double du = static_cast<double>(u) - place_.u_px, dv = static_cast<double>(v) - place_.v_px;
      if (du * du + dv * dv > place_.radius_px * place_.radius_px) continue;
      const std::array<std::uint8_t, 3> pixel = pixel_at(frame, u, v);
      for (std::size_t c = 0; c < channels; ++c) sum += pixel[c];
      number += static_cast<double>(channels);
    }
  }
  frames_[count_++] = {frame.capture_time, sent, number > 0.0 ? sum / number : 0.0};
}

}  // namespace touchline::latency
