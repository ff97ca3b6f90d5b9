// The strategy of strategy.py in C++. It uses nothing of Touchline, only sockets and nlohmann's JSON library. To build
// and run it:
//   g++ -std=c++20 -O2 tools/examples/strategy.cpp -o strategy && ./strategy
#include <arpa/inet.h>
#include <sys/socket.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

using nlohmann::json;

constexpr const char* kTeam = "blue";
constexpr double kGoalX = 1.1;  // goal of the other team, m; our goal is at -kGoalX

sockaddr_in local_port(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

double number(const json& object, const char* member) { return object.at(member).get<double>(); }

// Returns where the robot drives: around the ball, then behind it, then through it towards a half of the goal.
json attack(const json& robot, const json& ball) {
  const double x = number(ball, "x"), y = number(ball, "y");
  const double aim = std::abs(y) < 0.8 ? std::atan2(std::copysign(0.12, y) - y, kGoalX - x) : 0.0;
  const double dx = number(robot, "x") - x, dy = number(robot, "y") - y;
  const double along = dx * std::cos(aim) + dy * std::sin(aim), across = dy * std::cos(aim) - dx * std::sin(aim);
  if (along < -0.02 && std::abs(across) < 0.02 - 0.2 * along) {
    return {{"x", x + 0.4 * std::cos(aim)}, {"y", y + 0.4 * std::sin(aim)}};
  }
  const double beside = along < -0.06 ? 0.0 : std::copysign(0.12, across);
  return {{"x", x - 0.13 * std::cos(aim) - beside * std::sin(aim)},
          {"y", std::clamp(y - 0.13 * std::sin(aim) + beside * std::cos(aim), -0.84, 0.84)}};
}

json decide(const json& ball, const json& robots) {
  std::string attacker, keeper;
  double nearest_to_ball = 1e9, nearest_to_goal = 1e9;
  for (const auto& [id, robot] : robots.items()) {
    const double distance = std::hypot(number(robot, "x") + kGoalX, number(robot, "y"));
    if (distance < nearest_to_goal) nearest_to_goal = distance, keeper = id;
  }
  for (const auto& [id, robot] : robots.items()) {
    const double distance = std::hypot(number(robot, "x") - number(ball, "x"), number(robot, "y") - number(ball, "y")) +
                            (id == keeper ? 1.0 : 0.0);
    if (distance < nearest_to_ball) nearest_to_ball = distance, attacker = id;
  }
  json command = attack(robots.at(attacker), ball);
  command["id"] = std::stoi(attacker);
  json commands = json::array({command});
  if (keeper != attacker) {
    commands.push_back({{"id", std::stoi(keeper)},
                        {"x", 0.07 - kGoalX},
                        {"y", std::clamp(number(ball, "y"), -0.2, 0.2)},
                        {"theta", M_PI_2}});
  }
  return {{"commands", commands}};
}

}  // namespace

int main() {
  const int frames = socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in here = local_port(9870), touchline = local_port(20012);
  if (frames < 0 || bind(frames, reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0) {
    std::perror("port 9870");
    return 1;
  }
  std::vector<char> line(65536);
  while (true) {
    const ssize_t bytes = recv(frames, line.data(), line.size(), 0);
    if (bytes < 0) continue;
    const json frame = json::parse(line.begin(), line.begin() + bytes);
    const json &ball = frame.at("tracks").at("ball"), &robots = frame.at("robots").at(kTeam);
    if (ball.is_null() || robots.empty()) continue;  // without commands, robots stop after 0.2 s
    const std::string commands = decide(ball, robots).dump();
    sendto(frames, commands.data(), commands.size(), 0, reinterpret_cast<const sockaddr*>(&touchline),
           sizeof touchline);
  }
}
