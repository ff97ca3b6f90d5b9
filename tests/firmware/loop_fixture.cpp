#include "tests/firmware/loop_fixture.h"
#include "tests/results.h"

namespace touchline::testing {

PipelineParameters fake_camera_parameters() {
  PipelineParameters parameters;
  parameters.scan.format = PixelFormat::kRgb24;
  parameters.scan.width_px = FakeCamera::kWidth;
  parameters.scan.height_px = FakeCamera::kHeight;
  const auto color = [&](ColorId id, std::uint8_t red, std::uint8_t green) {
    const auto high = [](std::uint8_t low) { return static_cast<std::uint8_t>(low + 20); };
    parameters.scan.boxes.push_back({id, {red, green, 200}, {high(red), high(green), 255}});
  };
  color(1, 100, 100);
  color(2, 150, 100);
  color(3, 200, 100);
  FullModelParameters& camera = parameters.camera.full;
  camera.fx_px = camera.fy_px = 600.0f;  // 300 px per meter
  camera.cx_px = 31.5f;
  camera.cy_px = 23.5f;
  camera.rotation_rad = {3.14159265f, 0.0f, 0.0f};
  camera.position_m = {0.0f, 0.0f, 2.0f};
  TeamMarking& own = parameters.marker.teams[0];
  own.layout = paper_layout();
  own.team_color = 1;
  own.max_robots = 1;
  RobotMarking robot;
  robot.id = 0;
  robot.colors.push_back(2);
  own.robots.push_back(robot);
  parameters.marker.teams[1].layout = paper_layout();
  parameters.marker.ball.color = 3;
  return parameters;
}

LoopTest::LoopTest() {
  settings.faults.camera_timeout_s = 5.0;
  settings.faults.resume_after_emergency = true;
  settings.radio_delay = std::chrono::milliseconds(20);
}

LoopTest::~LoopTest() {
  if (loop) loop->close();
  EXPECT_FALSE(camera.leased);
}

Loop& LoopTest::start(LoopObserver observer, const PacketLayout& packets) {
  PipelineParameters parameters = fake_camera_parameters();
  parameters.radio = packets;
  EXPECT_TRUE(pipeline->configure(parameters).ok());
  loop = std::make_unique<Loop>(HalDevices{camera, radio, gpio, clock, true}, *pipeline, settings, *ring, observer);
  EXPECT_OK(loop->open());
  return *loop;
}

void LoopTest::run_until(double end_s) {
  while (now_s() < end_s) {
    const auto end = loop->iterate();
    ASSERT_FALSE(end.has_value()) << "ended at " << now_s() << " s";
  }
}

std::vector<SentPacket> LoopTest::packets(double from_s, double to_s) const {
  std::vector<SentPacket> found;
  for (const SentPacket& packet : radio.sent) {
    if (packet.at_s >= from_s && packet.at_s < to_s) found.push_back(packet);
  }
  return found;
}

bool LoopTest::all_stop(double from_s, double to_s) const {
  std::size_t stops = 0;
  const auto found = packets(from_s, to_s);
  for (const SentPacket& packet : found) stops += packet.stop ? 1 : 0;
  EXPECT_FALSE(found.empty()) << "no packets from " << from_s << " to " << to_s;
  EXPECT_TRUE(stops == 0 || stops == found.size()) << stops << " of " << found.size() << " are stop packets";
  return stops > 0;
}

std::vector<Report> LoopTest::reports() {
  std::vector<Report> all;
  Report report;
  while (ring->pop(report)) all.push_back(report);
  return all;
}

}  // namespace touchline::testing
