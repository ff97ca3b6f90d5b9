// The radios of the board file, and the addresses of the team file.
#include "firmware/radio_plan.h"

#include <gtest/gtest.h>

#include "tests/results.h"

namespace touchline {
namespace {

class RadioPlan : public ::testing::Test {
 protected:
  RadioPlan() {
    configuration_->board_where = config::Locations("board.toml");
    configuration_->board_where.note("radio.address", "board.toml:7");
    configuration_->board_where.note("radio.more[0].robots", "board.toml:12");
    configuration_->team_where = config::Locations("team.toml");
    for (int id = 0; id < 3; ++id) {
      const std::string path = "own.robot[" + std::to_string(id) + "]";
      configuration_->team_where.note(path, "team.toml:" + std::to_string(20 + id));
      configuration_->team.own.robot.push_back({id, {}, ""});
    }
    radio().backend = hal::RadioBackend::kUdp;
  }
  hal::RadioSettings& radio() { return configuration_->board.radio; }
  std::string& address(std::size_t robot) { return configuration_->team.own.robot[robot].address; }
  std::vector<PlannedRadio> plan() {
    const Result<std::vector<PlannedRadio>> planned = plan_radios(*configuration_);
    EXPECT_TRUE(planned.ok()) << planned.text();
    return planned.ok() ? planned.value() : std::vector<PlannedRadio>();
  }
  std::string refusal() { return plan_radios(*configuration_).text(); }

  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
};

TEST_F(RadioPlan, ReportsWithoutIdsNeedAPortOrAnAddressForEachRobot) {
  PacketField battery;
  battery.value = FieldValue::kBattery;
  configuration_->pipeline.telemetry = {};
  configuration_->pipeline.telemetry.fields.push_back(battery);
  configuration_->team_where.note("radio.telemetry", "team.toml:40");
  radio().port = 8081;
  for (std::size_t robot = 0; robot < 3; ++robot) address(robot) = "192.168.1.1" + std::to_string(robot);
  EXPECT_EQ(plan().size(), 1U);
  address(2) = address(0);
  EXPECT_EQ(refusal().find("team.toml:40: radio.telemetry: no field carries the id or the address, and radio of "
                           "board.toml does not tell which robot has sent a report"),
            0U)
      << refusal();
  radio().telemetry = false;
  EXPECT_EQ(plan().size(), 1U);
  radio().telemetry = true;
  radio().backend = hal::RadioBackend::kSerial;
  EXPECT_NE(refusal(), "");
  radio().robots = {0};
  for (const int robot : {1, 2}) {
    radio().more.emplace_back().backend = hal::RadioBackend::kSerial;
    radio().more.back().robots = {robot};
  }
  EXPECT_EQ(plan().size(), 3U);
}

TEST_F(RadioPlan, RobotsHaveAddressesOfTheirOwnOrACommonOne) {
  radio().port = 8081;
  radio().address = "192.168.1.255:9000";
  radio().local_port = 9001;
  radio().interface = "wlan0";
  address(0) = "192.168.1.11";
  address(2) = "192.168.1.13:8080";
  const std::vector<PlannedRadio> radios = plan();
  ASSERT_EQ(radios.size(), 1U);
  const hal::UdpRadioSettings& udp = radios[0].udp;
  EXPECT_EQ(udp.robots[0].ipv4, 0xc0a8010bU);
  EXPECT_EQ(udp.robots[0].port, 8081);
  EXPECT_FALSE(udp.robots[1].exists());
  EXPECT_EQ(udp.robots[2].port, 8080);
  EXPECT_EQ(udp.common.ipv4, 0xc0a801ffU);
  EXPECT_EQ(udp.common.port, 9000);
  EXPECT_EQ(udp.local_port, 9001);
  EXPECT_EQ(udp.interface, "wlan0");
  EXPECT_TRUE(radios[0].reaches.all());
}

TEST_F(RadioPlan, WrongAddressesAreReportedWithFileLineAndKey) {
  address(0) = "192.168.1.300:8081";
  address(1) = "192.168.1.12";
  EXPECT_EQ(refusal(),
            "team.toml:20: own.robot[0].address: \"192.168.1.300:8081\": expected an IPv4 address in numbers, such as "
            "192.168.1.11:8081\n"
            "team.toml:21: own.robot[1].address: \"192.168.1.12\": the port is missing: 192.168.1.11:8081, or "
            "radio.port for all robots\n"
            "team.toml:22: own.robot[2].address: is needed, because radio.address of the board file is empty");
  radio().address = "robots.local:8081";
  EXPECT_EQ(refusal(),
            "board.toml:7: radio.address: \"robots.local:8081\": expected an IPv4 address in numbers, such as "
            "192.168.1.11:8081");
}

TEST_F(RadioPlan, OtherRadiosReadAddressesTheirOwnWay) {
  radio().backend = hal::RadioBackend::kSerial;
  address(0) = "00:13:a2:00:40:52:29:3f";
  EXPECT_EQ(plan().size(), 1U);
}

TEST_F(RadioPlan, SeveralRadiosShareTheRobots) {
  radio().backend = hal::RadioBackend::kSerial;
  radio().robots = {0, 2};
  hal::RadioPortSettings second;
  second.backend = hal::RadioBackend::kUdp;
  second.address = "10.0.0.7:81";
  second.robots = {1};
  radio().more.push_back(second);
  const std::vector<PlannedRadio> radios = plan();
  ASSERT_EQ(radios.size(), 2U);
  EXPECT_TRUE(radios[0].reaches[0] && !radios[0].reaches[1] && radios[0].reaches[2]);
  EXPECT_TRUE(!radios[1].reaches[0] && radios[1].reaches[1] && !radios[1].reaches[2]);
  EXPECT_TRUE(radios[0].reaches[kAllRobots] && radios[1].reaches[kAllRobots]);

  radio().more[0].robots = {7};
  EXPECT_EQ(refusal(),
            "board.toml:12: radio.more[0].robots: there is no robot 7 in team.toml\n"
            "board.toml: radio.robots: no radio reaches robot 1");
  radio().more.assign(4, second);
  EXPECT_EQ(refusal(), "board.toml: radio.more[3]: is too many: at most 4 radios are used at once");
}

}  // namespace
}  // namespace touchline
