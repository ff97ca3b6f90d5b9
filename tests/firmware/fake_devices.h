#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "hal/camera.h"
#include "hal/clock.h"
#include "hal/device_parameters.h"
#include "hal/gpio.h"
#include "hal/radio.h"

// Fake devices that follow a script of the test. During a scripted fault all calls fail.
namespace touchline::testing {

/// Sleeping advances the time immediately.
class FakeClock final : public hal::Clock {
 public:
  [[nodiscard]] Instant now() const override { return now_; }
  void sleep_until(Instant instant) override { now_ = std::max(now_, instant); }

 private:
  Instant now_ = Instant(std::chrono::seconds(1000));
};

/// The device returns `code` in the interval [from_s, to_s) after the start of the test.
struct Fault {
  double from_s = 0.0, to_s = 0.0;
  ErrorCode code = ErrorCode::kIo;
};

/// Script and time line of a fake device.
class Script {
 public:
  explicit Script(hal::Clock& clock) : clock_(clock), begin_(clock.now()) {}
  void add(const Fault& fault) { faults_.push_back(fault); }
  [[nodiscard]] double now_s() const { return seconds(clock_.now() - begin_); }
  [[nodiscard]] Status status() const {
    for (const Fault& fault : faults_) {
      if (now_s() >= fault.from_s && now_s() < fault.to_s) return fault.code;
    }
    return {};
  }

 protected:
  hal::Clock& clock_;
  Instant begin_;
  std::vector<Fault> faults_;
};

/// Delivers a dark picture every 20 ms. During a fault, wait() returns its code (kTimeout: after the deadline). open()
/// also fails if the code is that of an absent device.
class FakeCamera final : public hal::Camera, public Script {
 public:
  static constexpr std::uint16_t kWidth = 64, kHeight = 48;
  static constexpr Duration kPeriod = std::chrono::milliseconds(20);
  explicit FakeCamera(hal::Clock& clock) : Script(clock), pixels_(std::size_t{kWidth} * kHeight * 3) {}

  [[nodiscard]] const hal::CameraInfo& info() const override { return info_; }

  /// Fills the following pictures with single pixels in the colors of fake_camera_parameters().
  void fill_with_colors();

  /// Draws the ball of fake_camera_parameters() into the following pictures: a disc of 12 pixels (0.04 m) in the
  /// middle.
  void show_ball();

  /// Draws the robot of fake_camera_parameters() into the following pictures, in the middle, heading right.
  void show_robot();

  Duration age = std::chrono::milliseconds(5);  // age of a frame when wait() returns the frame
  std::uint32_t skip_at = 0, skipped = 0;       // at this sequence number, `skipped` numbers are left out
  std::uint64_t misstamped_frame = 0;  // number (from 1) of a frame that is stamped with a future time; 0: none
  Duration misstamped_by{};            // how far in the future the frame's time stamp is
  std::uint64_t last_frame = ~std::uint64_t{0};  // wait() returns kEndOfStream after this number of frames
  std::uint16_t width = kWidth;                  // width of the frames
  std::vector<double> opened_s;                  // times of all attempts to open the device
  double starts_from_s = 0.0;                    // start() fails until this time
  double fits_from_s = 0.0;                      // the requested format is not offered until this time
  bool leased = false, running = false, is_open = false;
  std::optional<int> adjusted_exposure_us;
  std::string negotiated;  // return value of adjust()

 private:
  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<std::string> do_adjust(const hal::CameraSettings& settings) override;
  Result<hal::FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t) noexcept override { leased = false; }
  void do_stop() override { running = false; }
  void do_close() override;

  void paint(std::size_t u, std::size_t v, std::uint8_t red);
  std::vector<std::uint8_t> pixels_;
  hal::CameraInfo info_{PixelFormat::kRgb24, kWidth, kHeight, 50.0};
  Error failed(ErrorCode code) const { return {code, "/dev/fake0: scripted fault"}; }
  std::uint32_t sequence_ = 0;
  std::uint64_t frames_ = 0;
  Instant next_{};
};

struct SentPacket {
  double at_s = 0.0;
  bool stop = false;
  std::uint8_t sequence = 0;
};

class FakeRadio final : public hal::Radio, public Script {
 public:
  explicit FakeRadio(hal::Clock& clock) : Script(clock) { sent.reserve(100000); }

  /// Adds bytes that the next receive() calls return.
  void add_received(std::span<const std::byte> bytes, std::size_t sender = kAllRobots) {
    if (sender != received_from_) received_.clear();
    received_from_ = sender;
    received_.insert(received_.end(), bytes.begin(), bytes.end());
  }
  /// Transmission time of a packet. A packet that is sent in this time replaces the waiting one.
  Duration line_time{};

  std::vector<SentPacket> sent;
  std::vector<double> opened_s;
  std::optional<double> drained_s, closed_s;
  bool is_open = false;

 private:
  Result<void> do_open() override;
  Result<void> do_send(const Packet& packet, std::size_t receiver) override;
  Result<Duration> do_serve() override;
  Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;
  void put_on_line(const SentPacket& packet);
  std::vector<std::byte> received_;
  std::size_t received_from_ = kAllRobots;
  std::optional<SentPacket> waiting_;
  Instant line_free_{};
  Error failed(ErrorCode code) const { return {code, "/dev/fake1: scripted fault"}; }
};

/// A fault with code kOk stands for a pulled emergency stop.
class FakeGpio final : public hal::Gpio, public Script {
 public:
  explicit FakeGpio(hal::Clock& clock) : Script(clock) {
    led.reserve(100000);
    strobe.reserve(100000);
  }
  void pull(double from_s, double to_s) { pulled_.push_back({from_s, to_s}); }
  void press(double at_s) { pressed_.push_back(at_s); }

  std::vector<std::pair<double, bool>> led, strobe;
  Status outputs;  // result of setting status light and strobe
  Duration next_poll_in = Duration::max();
  int reads = 0;
  int opened = 0;

 private:
  Result<void> do_open() override;
  void do_close() override {}
  Result<void> do_set_status_led(bool on) override;
  Result<void> do_set_strobe(bool high) override;
  Result<hal::GpioInputs> do_inputs(Instant now) override;
  std::vector<double> pressed_;
  double read_s_ = -1.0;
  std::vector<std::pair<double, double>> pulled_;
  Error failed(ErrorCode code) const { return {code, "/dev/fakechip: scripted fault"}; }
};

}  // namespace touchline::testing
