#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

#include "core/pipeline.h"
#include "firmware/console/hub.h"
#include "firmware/console/web_server.h"
#include "tests/console/socket_client.h"

namespace touchline::console {

/// A console on a free port, and a thread that behaves like the loop: it takes the console's input before each frame,
/// and writes a snapshot and, if one is wanted, a picture after it.
class ConsoleServer : public ::testing::Test {
 protected:
  ConsoleServer();
  ~ConsoleServer() override { end(); }

  /// Call it once; the settings may be changed before.
  void start();
  void end();
  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  [[nodiscard]] ConsoleInput input() const {
    const std::scoped_lock lock(mutex_);
    return input_;
  }
  /// Returns the reasons for which the loop stops the robots, as bits of Halt.
  [[nodiscard]] std::uint32_t halt() const { return halt_; }
  /// Returns the member of a start that names the present stop; a page takes it from the newest state.
  [[nodiscard]] std::string stop_in_force() const { return "\"stop_number\":" + std::to_string(stop_number_); }
  /// Lets a session begin, as the main thread does. Call it in `use_files`: the hub is told with its next turn.
  /// `order`: the number that `use_files` got, if the session fulfills this order.
  void begin_session_later(bool is_draft, bool is_calibrated, std::string error = {}, std::uint64_t order = 0);
  /// Waits until the loop has got this, for at most half a minute.
  template <class Condition>
  [[nodiscard]] bool eventually(const Condition& condition) const {
    for (int i = 0; i < 6000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  WebServerSettings settings{"127.0.0.1", 0, "", {}};
  double picture_rate_hz = 30.0;
  std::string setup_socket;
  /// function that the hub calls to load files; empty: it cannot load any
  UseFiles use_files;
  std::shared_ptr<Recordings> recordings;
  std::atomic<bool> camera_delivers{true};
  /// Set it before start(): pictures then have a rectangle of the ball's color, kPatch, and a pipeline examines them.
  bool is_examined = false;
  static constexpr PixelBox kPatch{200, 100, 215, 115};
  /// Returns the values of the rectangle's pixels.
  [[nodiscard]] std::array<std::uint8_t, 3> patch_value() const;
  [[nodiscard]] ColorId patch_color() const { return configuration_->pipeline.marker.ball.color; }
  bool is_crowded = false;  // set before start(): 22 robots, and pictures whose JPEG is large
  std::atomic<std::uint64_t> pictures_copied{0}, frames{0};
  SharedReports reports;
  AdaptationRequests adaptation;

 private:
  void run_loop();

  std::shared_ptr<config::Configuration> configuration_ = std::make_shared<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_;
  std::unique_ptr<SnapshotRing> snapshots_ = std::make_unique<SnapshotRing>();
  PictureExchange pictures_;
  ConsoleLink link_;
  mutable std::mutex mutex_;
  ConsoleInput input_;  // input that the loop has taken
  std::atomic<std::uint32_t> halt_{kHaltNone};
  std::atomic<std::uint32_t> stop_number_{0};
  std::unique_ptr<Hub> hub_;
  std::function<void()> task_;  // task for the console's thread
  std::unique_ptr<WebServer> server_;
  std::atomic<bool> end_{false};
  std::thread loop_, console_;
};

/// Returns a message of type "stop", or one with further members: text_of("drive", "\"id\":1").
std::string text_of(std::string_view type, std::string_view members = {});

}  // namespace touchline::console
