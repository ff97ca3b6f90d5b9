// Classes that start threads; also run under the thread sanitizer.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <semaphore>

#include "firmware/report_printer.h"
#include "firmware/signals.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/firmware/loop_fixture.h"

namespace touchline::testing {
namespace {

using namespace std::chrono_literals;

// A camera whose driver hangs in open() after it was lost.
class HangingCamera final : public hal::Camera {
 public:
  [[nodiscard]] const hal::CameraInfo& info() const override { return info_; }
  std::binary_semaphore answer{0};

 private:
  Result<void> do_open() override {
    if (opened_++ > 0) answer.acquire();
    return {};
  }
  Result<void> do_start() override { return {}; }
  Result<hal::FrameLease> do_wait(Instant) override { return failure(ErrorCode::kDisconnected, "unplugged"); }
  void do_release(std::uint32_t) noexcept override {}
  void do_stop() override {}
  void do_close() override {}
  hal::CameraInfo info_;
  int opened_ = 0;
};

TEST(ThreadsLoop, StopPacketsContinueWhileADriverHangs) {
  hal::MonotonicClock clock;
  HangingCamera camera;
  FakeRadio radio(clock);
  FakeGpio gpio(clock);
  const auto pipeline = std::make_unique<Pipeline>();
  ASSERT_TRUE(pipeline->configure(fake_camera_parameters()).ok());
  const auto ring = std::make_unique<ReportRing>();
  LoopSettings settings;
  settings.faults.reopen_after_s = 0.01;
  settings.faults.stop_after_s = 0.02;  // an iteration takes at most 5 ms
  settings.duration = 400ms;
  Loop loop({camera, radio, gpio, clock}, *pipeline, settings, *ring);
  ASSERT_TRUE(loop.open().ok());
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop.run(stop), LoopEnd::kLimit);
  // 80 on an idle machine; on a loaded one an iteration can take several times as long.
  EXPECT_GE(radio.sent.size(), 20U);
  for (const SentPacket& packet : radio.sent) EXPECT_TRUE(packet.stop);
  camera.answer.release();
  loop.close();
}

class ThreadsReportPrinter : public LoopTest {};

TEST_F(ThreadsReportPrinter, PrintsTheReportsOfTheLoop) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* file = ::open_memstream(&text, &size);
  camera.add({1.0, 1.6, ErrorCode::kDisconnected});
  start();
  {
    ReportPrinterSettings printer_settings;
    printer_settings.expected.own = 1;
    const ReportPrinter printer(*ring, printer_settings, file, file);
    run_until(3.1);
  }
  std::fclose(file);
  const std::string printed(text, size);
  std::free(text);
  EXPECT_NE(printed.find("0.0 s  robots may move\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("camera: " + std::string(describe(ErrorCode::kDisconnected)) +
                         " (/dev/fake0: scripted fault); reopening it\n"),
            std::string::npos)
      << printed;
  EXPECT_NE(printed.find("robots halted: no good frame\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("camera: reopened\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("1 s  50.0 fps  own 0/1  opp 0/0  ball lost  latency"), std::string::npos) << printed;
}

TEST_F(ThreadsReportPrinter, DrawsEachMapOverTheLastOne) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* file = ::open_memstream(&text, &size);
  start();
  {
    ReportPrinterSettings printer_settings;
    printer_settings.map_columns = 52;
    const ReportPrinter printer(*ring, printer_settings, file, file);
    run_until(3.1);
  }
  std::fclose(file);
  const std::string printed(text, size);
  std::free(text);
  // 50 cells for 2.2 m, 20 rows for 1.8 m, the border, two lines of status.
  const std::string up = "\x1b[24A";
  const std::size_t first = printed.find(up);
  ASSERT_NE(first, std::string::npos);
  const std::size_t second = printed.find(up, first + 1);
  ASSERT_NE(second, std::string::npos);
  EXPECT_EQ(printed.find(up, second + 1), std::string::npos) << "three maps, two of them drawn over another one";
  const std::string picture = printed.substr(first, second - first);
  EXPECT_EQ(std::count(picture.begin(), picture.end(), '\n'), 24);
}

TEST_F(ThreadsReportPrinter, TerminationStopsTheRobots) {
  const std::atomic<bool>& stop = handle_stop_signals();
  ASSERT_FALSE(stop.load());
  start();
  run_until(1.0);
  std::raise(SIGTERM);
  EXPECT_EQ(loop->run(stop), LoopEnd::kRequested);
  ASSERT_EQ(radio.sent.size(), 55U);
  EXPECT_FALSE(radio.sent[49].stop);
  for (std::size_t i = 50; i < 55; ++i) EXPECT_TRUE(radio.sent[i].stop);
  std::raise(SIGPIPE);  // ignored
}

}  // namespace
}  // namespace touchline::testing
