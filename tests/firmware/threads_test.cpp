// Classes that start threads; also run under the thread sanitizer.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
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

std::string content_of(std::FILE* file) {
  std::rewind(file);
  std::string text(std::size_t{1} << 20, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file));
  return text;
}

class ThreadsReportPrinter : public LoopTest {};

TEST_F(ThreadsReportPrinter, PrintsTheReportsOfTheLoop) {
  std::FILE* const file = std::tmpfile();
  camera.add({1.0, 1.6, ErrorCode::kDisconnected});
  start();
  {
    hal::TextOutput output(::fileno(file), ::fileno(file));
    ReportPrinterSettings printer_settings;
    printer_settings.expected.own = 1;
    const ReportPrinter printer(*ring, printer_settings, output);
    run_until(3.1);
  }
  const std::string printed = content_of(file);
  std::fclose(file);
  EXPECT_NE(printed.find("0.0 s  robots may move\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("camera: " + std::string(describe(ErrorCode::kDisconnected)) +
                         " (/dev/fake0: scripted fault); reopening it\n"),
            std::string::npos)
      << printed;
  EXPECT_NE(printed.find("robots halted: no good frame\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("camera: reopened\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("1 s  50.0 fps  own 0/1  opp 0/0  ball lost  playing right  latency"), std::string::npos)
      << printed;
}

TEST_F(ThreadsReportPrinter, DrawsEachMapOverTheLastOne) {
  std::FILE* const file = std::tmpfile();
  start();
  {
    hal::TextOutput output(::fileno(file), ::fileno(file));
    ReportPrinterSettings printer_settings;
    printer_settings.map_columns = 52;
    const ReportPrinter printer(*ring, printer_settings, output);
    run_until(3.1);
  }
  const std::string printed = content_of(file);
  std::fclose(file);
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

// The reader of a pipe does not read: the other receivers still get every report, and nothing waits at the end.
TEST_F(ThreadsReportPrinter, ABlockedTerminalHoldsUpNobody) {
  std::signal(SIGPIPE, SIG_IGN);  // as in the program
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK), 0);
  while (::write(ends[1], "full", 4) > 0) {
  }
  ASSERT_EQ(::fcntl(ends[1], F_SETFL, 0), 0);
  std::atomic<int> statuses{0}, halts{0};
  start();
  {
    hal::TextOutput output(ends[1], ends[1]);
    {
      ReportPrinterSettings printer_settings;
      printer_settings.on_status = [&](const StatusReport&) { ++statuses; };
      printer_settings.on_halt = [&](const HaltReport&) { ++halts; };
      const ReportPrinter printer(*ring, printer_settings, output);
      run_until(3.1);
      loop->send_final_stops();
    }
    EXPECT_FALSE(output.finish(std::chrono::milliseconds(1)));
  }
  EXPECT_EQ(statuses, 3);
  EXPECT_EQ(halts, 1);
  EXPECT_TRUE(radio.sent.back().stop);
  ::close(ends[0]);  // lets the writer continue, which may still use the other end
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
