// Every function of the robots' header in one object. Its compiler options are those of a robot
// (tests/robot/CMakeLists.txt), and tests/checks reads which symbols it needs.
#include "tools/robot/touchline_robot.h"

namespace touchline_robot {

int use_everything(const uint8_t* bytes, uint8_t size, uint32_t now_us);

int use_everything(const uint8_t* bytes, uint8_t size, uint32_t now_us) {
  Robot robot(3, 7);
  PacketFinder finder;
  Telemetry telemetry(3);
  finder.add(bytes[0]);
  int sum = 0;
  while (finder.find()) sum += finder.size() + finder.team() + finder.bytes()[0];
  finder.clear();
  sum += robot.receive(bytes, size, now_us) ? 1 : 0;
  sum += robot.receive_datagram(bytes, size, now_us) ? 1 : 0;
  robot.update(now_us);
  const WheelSpeeds wheels = limited(robot.wheels(), 1000);
  sum += pwm_from_speed(wheels.left_mmps, 1500, 30) + static_cast<int>(turns_per_second(wheels.right_mmps, 40.0f));
  sum += wheels_from_twist(500, 1000, 75).left_mmps + (robot.has_link() ? robot.id() : 0);
  uint8_t packet[kTelemetryBytes];
  if (telemetry.is_due(now_us)) sum += telemetry.write(7400, robot.link_percent(), packet)[9];
  return sum;
}

}  // namespace touchline_robot
