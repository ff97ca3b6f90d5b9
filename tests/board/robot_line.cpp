#include "tests/board/robot_line.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "tools/robot/touchline_robot.h"

namespace touchline::board {
namespace {

// Time of a byte at 115200 baud. The robot's clock counts bytes, because the guest may be a hundred times slower than
// this host: pauses on the socket are no pauses on the line.
constexpr std::uint32_t kByteTime_us = 87;
// 0.6 s. Reports are sent while the robot drives, because the other end does not read them after its last command.
constexpr std::uint64_t kPacketsPerReport = 30;
constexpr std::uint16_t kBattery_mv = 7412;

}  // namespace

Result<RobotLineResult> listen_as_robot(int line, std::uint8_t id, double patience_s, double quiet_s) {
  ::touchline_robot::Robot robot(id);
  ::touchline_robot::Telemetry telemetry(id);
  RobotLineResult result;
  std::uint32_t now_us = 0;
  for (;;) {
    pollfd entry{line, POLLIN, 0};
    const double wait_s = result.bytes == 0 ? patience_s : quiet_s;
    if (::poll(&entry, 1, static_cast<int>(wait_s * 1000.0)) <= 0) break;
    std::array<std::uint8_t, 256> bytes;
    const ssize_t got = ::read(line, bytes.data(), bytes.size());
    if (got <= 0) return failure(ErrorCode::kIo, "the radio socket was closed");
    for (ssize_t i = 0; i < got; ++i) {
      now_us += kByteTime_us;
      ++result.bytes;
      if (!robot.receive(bytes[static_cast<std::size_t>(i)], now_us)) continue;
      ++result.obeyed;
      const std::array<int, 2> told{robot.wheels().left_mmps, robot.wheels().right_mmps};
      if (result.told.empty() || result.told.back() != told) result.told.push_back(told);
      if (result.obeyed % kPacketsPerReport != 0 || told == std::array<int, 2>{}) continue;
      std::uint8_t report[::touchline_robot::kTelemetryBytes];
      telemetry.write(kBattery_mv, robot.link_percent(), report);
      if (::send(line, report, sizeof report, MSG_NOSIGNAL) == static_cast<ssize_t>(sizeof report)) ++result.reports;
    }
  }
  if (result.bytes == 0) return failure(ErrorCode::kTimeout, "no byte arrived for robot %d", int{id});
  return result;
}

}  // namespace touchline::board
