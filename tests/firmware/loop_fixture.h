#pragma once

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/loop.h"
#include "tests/firmware/fake_devices.h"

namespace touchline::testing {

/// Parameters for the pictures of FakeCamera, which show an empty dark field.
PipelineParameters fake_camera_parameters();

/// A loop on fake devices and a fake clock.
class LoopTest : public ::testing::Test {
 protected:
  LoopTest();
  ~LoopTest() override;

  /// Creates and opens the loop with `settings`. Call it once per test.
  Loop& start(LoopObserver observer = {}, const PacketLayout& packets = touchline_layout());
  /// Iterates until `end_s` after the start of the test.
  void run_until(double end_s);
  [[nodiscard]] double now_s() const { return camera.now_s(); }

  /// Returns the packets sent in [from_s, to_s).
  [[nodiscard]] std::vector<SentPacket> packets(double from_s, double to_s) const;
  /// Returns whether these packets are stop packets. Fails if there are none, or both kinds.
  [[nodiscard]] bool all_stop(double from_s, double to_s) const;
  /// Takes all reports from the ring.
  std::vector<Report> reports();

  FakeClock clock;
  FakeCamera camera{clock};
  FakeRadio radio{clock};
  FakeGpio gpio{clock};
  LoopSettings settings;
  std::unique_ptr<Pipeline> pipeline = std::make_unique<Pipeline>();
  std::unique_ptr<ReportRing> ring = std::make_unique<ReportRing>();
  std::unique_ptr<Loop> loop;
};

}  // namespace touchline::testing
