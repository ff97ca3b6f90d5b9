#pragma once

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/loop.h"
#include "tests/firmware/fake_devices.h"

namespace touchline::testing {

/// A pipeline for FakeCamera's pictures, in which there is nothing to see.
PipelineParameters dark_room();

/// A loop on fake devices and a fake clock.
class LoopTest : public ::testing::Test {
 protected:
  LoopTest();
  ~LoopTest() override;

  /// Builds and opens the loop with `settings`; once a test.
  Loop& start(LoopObserver observer = {});
  /// Runs until so long after the begin.
  void run_until(double end_s);
  [[nodiscard]] double now_s() const { return camera.now_s(); }

  /// Packets sent in [from_s, to_s).
  [[nodiscard]] std::vector<SentPacket> packets(double from_s, double to_s) const;
  /// All of them are stop packets, or none is; fails when there are none or both kinds.
  [[nodiscard]] bool all_stop(double from_s, double to_s) const;
  /// Everything in the ring.
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
