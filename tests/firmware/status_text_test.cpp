#include "firmware/status_text.h"

#include <gtest/gtest.h>

namespace touchline {
namespace {

using namespace std::chrono_literals;

StatusReport good_status() {
  StatusReport status;
  status.elapsed_s = 12.02;
  status.rate_hz = 60.0;
  status.own_seen = status.opponents_seen = 5;
  status.ball_seen = true;
  status.ball = {0.12f, -0.3f};
  status.p50 = 1200us;
  status.p99 = 2300us;
  status.max = 3100us;
  status.packets = 720;
  return status;
}

TEST(StatusText, LineWithoutProblems) {
  EXPECT_EQ(status_line(good_status(), {5, 5, {}}),
            "12 s  60.0 fps  own 5/5  opp 5/5  ball (0.12, -0.30)  playing right  latency p50 1.2 p99 2.3 max 3.1 ms  "
            "packets 720");
}

TEST(StatusText, LineWithProblems) {
  StatusReport status = good_status();
  status.ball_seen = false;
  status.frames_lost = 3;
  status.overloads = 2;
  status.faults = 7;
  status.halt = kHaltNoFrames | kHaltEmergency;
  EXPECT_EQ(
      status_line(status, {5, 5, {}}),
      "12 s  60.0 fps  own 5/5  opp 5/5  ball lost  playing right  latency p50 1.2 p99 2.3 max 3.1 ms  packets 720  "
      "frames lost 3  overloads 2  faults 7  HALTED: no good frame, emergency stop");
}

TEST(StatusText, ASourceOfPosesIsNamedAndItsUnusedPacketsAreCounted) {
  StatusReport status = good_status();
  status.packets_ignored = 12;
  const std::string line = status_line(status, {5, 5, {}, "ssl-vision"});
  EXPECT_NE(line.find("12 s  60.0 fps  of ssl-vision  own 5/5"), std::string::npos) << line;
  EXPECT_NE(line.find("  packets ignored 12"), std::string::npos) << line;
  LoopStatistics statistics;
  EXPECT_EQ(summary(statistics, LoopEnd::kLimit).find("source"), std::string::npos);
  statistics.source = {1, 2, 3, 4};
  EXPECT_NE(summary(statistics, LoopEnd::kLimit)
                .find("\nsource    packets ignored: 1 late, 2 doubled, 3 of a second sender, 4 malformed\n"),
            std::string::npos);
}

TEST(StatusText, ScoreAndDirectionOfPlay) {
  StatusReport status = good_status();
  status.score = Score{1, 2};
  status.own_on_positive_half = true;
  EXPECT_NE(status_line(status, {5, 5, {}}).find("  ball (0.12, -0.30)  score 1:2  playing left  latency"),
            std::string::npos);
  LoopStatistics statistics;
  EXPECT_NE(summary(statistics, LoopEnd::kLimit).find("\ngame      playing to the right\n"), std::string::npos)
      << "nobody tells the score";
  statistics.score = Score{0, 3};
  statistics.own_on_positive_half = true;
  EXPECT_NE(summary(statistics, LoopEnd::kLimit).find("\ngame      score 0 : 3, playing to the left\n"),
            std::string::npos);
}

TEST(StatusText, ChangedLightAndFrozenAdaptation) {
  StatusReport status = good_status();
  const std::string plain = status_line(status, {5, 5, {}});
  status.brightness = 1.04f;
  EXPECT_EQ(status_line(status, {5, 5, {}}), plain) << "noise";
  status.brightness = 0.876f;
  EXPECT_EQ(status_line(status, {5, 5, {}}), plain + "  light -12 %");
  status.adaptation = AdaptationMode::kFrozen;
  EXPECT_EQ(status_line(status, {5, 5, {}}), plain + "  light -12 %  adaptation frozen");
}

TEST(StatusText, Faults) {
  FaultReport fault;
  fault.elapsed_s = 3.25;
  fault.code = ErrorCode::kDisconnected;
  fault.action = FaultAction::kReopen;
  fault.reason.set("/dev/video0: unplugged");
  EXPECT_EQ(fault_line(fault), std::string("3.2 s  camera: ") + describe(ErrorCode::kDisconnected) +
                                   " (/dev/video0: unplugged); reopening it");
  fault.device = Device::kGpio;
  fault.action = FaultAction::kContinueWithout;
  EXPECT_TRUE(fault_line(fault).ends_with("; continuing without it"));
  fault.device = Device::kRadio;
  fault.code = ErrorCode::kOk;
  EXPECT_EQ(fault_line(fault), "3.2 s  radio: reopened");
  EXPECT_EQ(halt_line({1.0, kHaltNone, kHaltUnreadableLine}), "1.0 s  robots may move");
  EXPECT_EQ(halt_line({1.0, kHaltUnreadableLine, kHaltNone}), "1.0 s  robots halted: emergency stop cannot be read");
}

TEST(StatusText, CutsOffLongErrorTexts) {
  FaultReport fault;
  fault.reason.set(std::string(1000, 'x'));
  EXPECT_EQ(std::string(fault.reason.c_str()).size(), kMaxReasonBytes - 1);
}

TEST(FieldMap, DrawsObjectsAtTheirPositions) {
  StatusReport status = good_status();
  status.ball = {0.0f, 0.0f};
  status.robots.push_back({Team::kOwn, 3, false, {{-0.9f, 0.7f}, 0.0f}});
  status.robots.push_back({Team::kOpponent, kUnknownId, false, {{0.9f, -0.7f}, 0.0f}});
  status.robots.push_back({Team::kOwn, kUnknownId, false, {{5.0f, -0.3f}, 0.0f}});  // far outside: at the border
  const FieldParameters field;
  const std::string map = field_map(status, field, 60, false);
  std::vector<std::string> rows;
  for (std::size_t begin = 0; begin < map.size();) {
    const std::size_t end = map.find('\n', begin);
    rows.push_back(map.substr(begin, end - begin));
    begin = end + 1;
  }
  ASSERT_EQ(rows.size(), 26U);  // 2.2 : 1.8 in cells twice as high as wide, and the border
  for (const std::string& row : rows) EXPECT_EQ(row.size(), 60U);
  const auto find = [&](char letter) {
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (const std::size_t column = rows[row].find(letter); column != std::string::npos) {
        return std::pair{static_cast<int>(row), static_cast<int>(column)};
      }
    }
    return std::pair{-1, -1};
  };
  EXPECT_EQ(find('3'), std::pair(3, 6));  // upper left: y is to the left of x
  EXPECT_EQ(rows[3][7], '-');             // the heading points along x
  EXPECT_EQ(find('x'), std::pair(22, 53));
  EXPECT_EQ(find('o'), std::pair(13, 30));
  EXPECT_EQ(find('?').second, 59);
  EXPECT_EQ(map.find('\x1b'), std::string::npos);
  EXPECT_NE(field_map(status, field, 60, true).find("\x1b[1;33mo\x1b[0m"), std::string::npos);
}

TEST(StatusLine, ShowsTheWheelSpeedsThatARobotReports) {
  StatusReport status = good_status();
  status.robot_status.push_back({2, 7.5f, kLinkUnknown, 0.1, false, WheelSpeeds{0.251f, -0.5f}});
  const std::string line = status_line(status, {});
  EXPECT_NE(line.find("robots 2: 7.50 V wheels 0.25 -0.50 m/s"), std::string::npos) << line;
}

TEST(StatusLine, ShowsTheTelemetry) {
  StatusReport status = good_status();
  status.robot_status.push_back({0, 7.923f, 98, 0.4, false});
  status.robot_status.push_back({1, 0.0f, 88, 3.2, false});
  status.robot_status.push_back({4, 6.75f, kLinkUnknown, 0.1, true});
  status.packets_dropped = 3;
  status.halt = kHaltStart;
  const std::string line = status_line(status, {});
  EXPECT_NE(line.find("  packets dropped 3  robots 0: 7.92 V 98 %, 1: 88 % (3 s ago), 4: 6.75 V LOW  HALTED: waiting "
                      "for the start button"),
            std::string::npos)
      << line;
  EXPECT_EQ(battery_line({12.34, 4, 6.754f}), "12.3 s  robot 4: battery is low, 6.75 V");
}

TEST(HaltLine, ShowsTheFigureOfAPictureThatIsNotTheTruth) {
  PictureTrace picture;
  picture.repeats = true;
  picture.repeated_share = 0.5f;
  picture.repeated_s = 0.25f;
  EXPECT_EQ(halt_line({1.0, kHaltRepeats, kHaltNone, 0, picture}),
            "1.0 s  robots halted: the camera repeats its pictures (50 % of the picture, 0.25 s old)");
  picture.replays = true;
  EXPECT_EQ(
      halt_line({1.0, kHaltRepeats, kHaltNone, 0, picture}),
      "1.0 s  robots halted: the camera repeats its pictures (50 % of the picture, 0.25 s old); check the camera, "
      "then press Start");
  picture.overload_frames = 7;
  picture.field_share = 0.034f;
  EXPECT_EQ(halt_line({1.0, kHaltOverload | kHaltField, kHaltNone, 0, picture}),
            "1.0 s  robots halted: too many colored regions in the picture (7 frames in a row), the field is not "
            "recognizable (3 % of "
            "it)");
  picture.contradicts = true;
  picture.commanded = 5;
  picture.contradicting = 4;
  EXPECT_EQ(halt_line({1.0, kHaltMotion, kHaltNone, 0, picture}),
            "1.0 s  robots halted: robots do not move as commanded (4 of 5 commanded robots); check batteries, radio "
            "and picture, then press Start");
  EXPECT_EQ(standing_line({2.0, 3}),
            "2.0 s  all robots stand although they are commanded to move: check batteries, radio and picture");
}

TEST(DriveLine, NamesKeyStatedAndMeasuredValue) {
  const ComparedValue delay{0.018, 0.0621, {0.0621, 0.0004, true}};
  EXPECT_EQ(drive_line({12.34, DriveReport::Value::kDelay, kUnknownId, {delay, {}}}),
            "12.3 s  radio.delay_s of the board file is 18 ms, but the robots show 62.1 +- 0.4 ms, which is used: "
            "measure it with touchline-radio and correct the file");
  const ComparedValue left{1.0, 1.08, {1.08, 0.003, true}}, right{1.0, 1.0, {0.998, 0.004, true}};
  EXPECT_EQ(drive_line({30.0, DriveReport::Value::kGain, 3, {left, right}}),
            "30.0 s  robot 3: own.robot.wheel_gain of the team file is 1.000, 1.000, but its wheels show 1.080, 1.000 "
            "(+- 0.004); these are used: measure it with touchline-radio and correct the file")
      << "the values in force";
  EXPECT_EQ(drive_line({31.0, DriveReport::Value::kLag, kUnknownId, {ComparedValue{0.08, 0.04, {}}, {}}}),
            "31.0 s  tracking.robot.wheel_lag_s of the team file is 80 ms, but the robots show 40.0 ms, which is used: "
            "measure it with touchline-radio and correct the file")
      << "nothing is measured any more";
}

TEST(FieldMap, OmitsPosesThatAreNotNumbers) {
  StatusReport status = good_status();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  status.robots.push_back({Team::kOwn, 3, false, {{nan, nan}, nan}});
  EXPECT_EQ(field_map(status, {}, 60, false).find('3'), std::string::npos);
}

TEST(Summary, ContainsAllCounts) {
  LoopStatistics statistics;
  statistics.end = statistics.begin + 10s;
  statistics.frames = 600;
  statistics.good_frames = 598;
  statistics.frames_lost = 4;
  statistics.packets = 612;
  statistics.packets_dropped = 7;
  statistics.stop_packets = 5;
  statistics.faults[0][static_cast<std::size_t>(ErrorCode::kDisconnected)] = 2;
  statistics.reopened[0] = 2;
  statistics.latency.add(2ms);
  statistics.robots.foreign_bytes = 900;
  statistics.score = Score{2, 1};
  statistics.robots.robots.push_back({{0, 5, 7.92f, 98}, statistics.end - 500ms, 20, 1, false});
  statistics.robots.robots.push_back({{12, 9, 6.8f, kLinkUnknown}, statistics.end - 4s, 3, 0, true});
  EXPECT_EQ(
      summary(statistics, LoopEnd::kRequested),
      "end       stopped on request\n"
      "frames    600 in 10.0 s (60.0 per second), 4 lost, 2 unusable\n"
      "game      score 2 : 1, playing to the right\n"
      "latency   capture to send: p50 2.00  p90 2.00  p99 2.00  p99.9 2.00  max 2.00 ms\n"
      "packets   605 sent, 5 of them stop packets; 0 refused, 7 dropped for newer ones\n"
      "robot 0   7.92 V 98 % 0.5 s before the end; 20 reports, 1 missed\n"
      "robot 12  6.80 V 4.0 s before the end; 3 reports, 0 missed; BATTERY LOW\n"
      "radio     900 received bytes are not from reports of robots: check radio.baud, and whether the radio module "
      "echoes or sends messages\n"
      "overload  0 frames (0 runs and 0 regions did not fit)\n"
      "faults    camera: " +
          std::string(describe(ErrorCode::kDisconnected)) +
          ", 2 times\n"
          "reopened  camera, 2 times\n");
}

// Noise damages some reports on every link, in the arena too. The following reports show that their numbers are
// missing.
TEST(Summary, DamagedReportsAreNoForeignBytes) {
  constexpr std::size_t kReportBytes = 10;
  LoopStatistics statistics;
  statistics.robots.report_bytes = kReportBytes;
  statistics.robots.robots.push_back({{0, 5, 7.92f, 98}, statistics.end, 58, 2, false});
  statistics.robots.robots.push_back({{1, 5, 7.92f, 98}, statistics.end, 60, 0, false});
  const auto warns = [&](std::uint64_t foreign_bytes) {
    statistics.robots.foreign_bytes = foreign_bytes;
    return summary(statistics, LoopEnd::kLimit).find("not from reports") != std::string::npos;
  };
  EXPECT_FALSE(warns(2 * kReportBytes)) << "two missed reports";
  EXPECT_FALSE(warns(4 * kReportBytes)) << "and the last one of each robot";
  EXPECT_TRUE(warns(4 * kReportBytes + 1));
  statistics.robots.robots.clear();
  EXPECT_TRUE(warns(1)) << "no robot was heard";
}

}  // namespace
}  // namespace touchline
