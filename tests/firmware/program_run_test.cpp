// Runs of the program touchline: how they begin and end, exit codes and output.
#include <fcntl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/console/socket_client.h"
#include "tests/firmware/program_fixture.h"

namespace touchline::testing {
namespace {

// With the console, a board without calibration runs, so that it can be set up on the page. This does not apply to a
// path on the command line.
TEST_F(Program, AVenueThatIsNotCalibratedNeedsTheConsoleAndAMistypedOneIsAnError) {
  const std::string run = "run --headless --frames 3 --console 127.0.0.1:0 ";
  const CommandOutput mistyped = touchline(run + board() + "--venue '" + (folder_ / "venu.toml").string() + "'");
  EXPECT_EQ(mistyped.code, 1);
  EXPECT_NE(mistyped.text.find("venu.toml: "), std::string::npos) << mistyped.text;
  EXPECT_EQ(mistyped.text.find("set the board up in the console"), std::string::npos) << mistyped.text;

  std::filesystem::remove(folder_ / "venue.toml");
  const CommandOutput not_yet = touchline(run + board());
  EXPECT_EQ(not_yet.code, 0) << not_yet.text;
  EXPECT_NE(not_yet.text.find("set the board up in the console"), std::string::npos) << not_yet.text;
  EXPECT_EQ(touchline("run --headless --frames 3 " + board()).code, 1);
}

TEST_F(Program, SaysAtTheStartThatPacketsWithoutATeamNumberDriveEveryRobot) {
  const std::string run = "run --headless --frames 3 --board '" TOUCHLINE_MOCK_BOARD "' ";
  const std::string note = "robots obey every Touchline on their channel";
  const CommandOutput without = touchline(run);
  EXPECT_EQ(without.code, 0) << without.text;
  EXPECT_NE(without.text.find(note), std::string::npos) << without.text;
  const CommandOutput with = touchline(run + "--set team_number=7");
  EXPECT_EQ(with.code, 0) << with.text;
  EXPECT_EQ(with.text.find(note), std::string::npos) << with.text;
}

// This is the only place with the hash of a game. It covers the whole way from rendered picture to wheels.
TEST_F(Program, AGameInTheArenaKeepsItsHash) {
  constexpr const char* kHash = "06f549a44f5958c1";
  const CommandOutput game = touchline("run --board '" TOUCHLINE_MOCK_BOARD "' --duration 3 --seed 1 --headless");
  ASSERT_EQ(game.code, 0) << game.text;
  const std::string before = "\narena state: ";
  const std::size_t at = game.text.find(before);
  ASSERT_NE(at, std::string::npos) << game.text;
  EXPECT_EQ(game.text.substr(at + before.size()), std::string(kHash) + "\n")
      << "The game of `tools/run --headless --duration 3 --seed 1` has changed. If your change should not change "
         "results, "
         "look for the mistake. If it should, put the new hash here, and say in the commit message why it changed.";
  EXPECT_NE(game.text.find("\ngame      score 0 : 0, playing to the right\n"), std::string::npos) << game.text;
  EXPECT_NE(game.text.find("  score 0:0  playing right  latency"), std::string::npos) << game.text;
  EXPECT_EQ(game.text.find("not from reports"), std::string::npos) << "the arena's noise is no fault of the radio";
}

TEST_F(Program, NoColorLeavesTheMapWithoutColors) {
  const auto map_with = [](const std::string& environment) {
    return run_command(environment + " TERM=xterm script -qec \"'" TOUCHLINE_PROGRAM
                                     "' run --board '" TOUCHLINE_MOCK_BOARD
                                     "' --pace fast --status-interval 0.1 --frames 10\" /dev/null 2>&1")
        .text;
  };
  const std::string red = "\x1b[1;31mx", colored = map_with("env -u NO_COLOR"), plain = map_with("NO_COLOR=1");
  EXPECT_NE(colored.find(red), std::string::npos) << colored;
  EXPECT_EQ(plain.find("\x1b[1;"), std::string::npos) << plain;
  EXPECT_EQ(plain.find("\x1b[2m"), std::string::npos) << plain;
  EXPECT_NE(plain.find("+----"), std::string::npos) << "the map is drawn: " << plain;
}

TEST_F(Program, InvalidFilesEndARunBeforeDevicesAreOpened) {
  write_board("v4l2", "there-is-no-such-camera");
  const CommandOutput outcome = touchline("run " + board() + "--set own.color=mauve");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.text.find("there-is-no-such-camera"), std::string::npos) << outcome.text;
}

TEST_F(Program, AMissingDeviceGivesExitCode2) {
  write_board("v4l2", "there-is-no-such-camera");
  const CommandOutput outcome = touchline("run " + board());
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.text.find("camera: "), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("there-is-no-such-camera"), std::string::npos) << outcome.text;
}

// On the page, a person can see what is missing, and choose the camera.
TEST_F(Program, WithoutItsCameraThePageIsServedAndSaysWhy) {
  write_board("v4l2", "there-is-no-such-camera");
  const std::string board_file = (folder_ / "board.toml").string(), output = (folder_ / "output.txt").string();
  const pid_t process = ::fork();
  if (process == 0) {
    const int file = ::open(output.c_str(), O_WRONLY | O_CREAT, 0600);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(file, stream);
    ::execl(TOUCHLINE_PROGRAM, "touchline", "run", "--headless", "--board", board_file.c_str(), "--console",
            "127.0.0.1:0", nullptr);
    ::_exit(127);
  }
  std::smatch found;
  std::string text;
  constexpr useconds_t kPause_us = 10'000;
  for (int i = 0; i < 3000 && found.empty(); ++i) {
    ::usleep(kPause_us);
    std::ifstream stream(output);
    text.assign(std::istreambuf_iterator<char>(stream), {});
    std::regex_search(text, found, std::regex(R"(http://127\.0\.0\.1:(\d+))"));
  }
  ASSERT_FALSE(found.empty()) << text;
  const auto port = static_cast<std::uint16_t>(std::stoi(found[1]));
  EXPECT_EQ(console::get(port, "/").status, 200);
  const nlohmann::json ports = nlohmann::json::parse(console::get(port, "/ports").body);
  EXPECT_TRUE(ports["serial_ports"].is_array()) << ports;
  {
    console::SocketPage page(port);
    ASSERT_EQ(page.status(), 101);
    // The first one may be older than the loop's first report.
    nlohmann::json lost;
    for (int i = 0; i < 5 && lost.empty(); ++i) {
      lost = nlohmann::json::parse(page.read_type("status").value_or("{}")).value("lost", nlohmann::json());
    }
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_EQ(lost[0]["device"], "camera");
    EXPECT_NE(lost[0]["reason"].get<std::string>().find("there-is-no-such-camera"), std::string::npos) << lost;
  }
  EXPECT_EQ(testing::exit_code_after_termination(process, 20), 0);
}

// Another camera, or another mode, invalidates the calibration but not the page, on which the field can be calibrated
// again.
TEST_F(Program, ACalibrationForAnotherPictureNeedsTheConsole) {
  const std::string run = "run --headless --frames 3 --set camera.width_px=32 --set camera.height_px=24 ";
  for (int i = 0; i < 30; ++i) {
    write("frames/" + std::to_string(i) + ".ppm", "P6\n32 24\n255\n" + std::string(std::size_t{32} * 24 * 3, '\0'));
  }
  const CommandOutput served = touchline(run + "--console 127.0.0.1:0 " + board());
  EXPECT_EQ(served.code, 0) << served.text;
  EXPECT_NE(served.text.find("the calibration is for pictures of 64 x 48 pixels"), std::string::npos) << served.text;
  EXPECT_NE(served.text.find("robots stay stopped; set the board up in the console"), std::string::npos) << served.text;
  EXPECT_EQ(touchline(run + board()).code, 1);
  EXPECT_EQ(touchline("check --set camera.width_px=32 " + board()).code, 1) << "check stays strict";
}

TEST_F(Program, PlaysAWholeRecording) {
  const CommandOutput outcome = touchline("run --headless --status-interval 0.25 " + board());
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("own 0/1  opp 0/0  ball lost  playing right  latency p50"), std::string::npos)
      << outcome.text;
  EXPECT_NE(outcome.text.find("end       end of the input\nframes    30 in "), std::string::npos) << outcome.text;
}

TEST_F(Program, TheStatusLineStatesTheOffsetToUnixTimeWhileSomethingIsPublished) {
  const std::string command = "run --headless --status-interval 0.25 " + board();
  const CommandOutput outcome =
      touchline(command + "--publish 'json=unix://" + (folder_ / "frames").string() + "-socket'");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  // steady_clock is CLOCK_MONOTONIC.
  const std::chrono::duration<double> offset =
      std::chrono::system_clock::now().time_since_epoch() - std::chrono::steady_clock::now().time_since_epoch();
  std::smatch found;
  const std::regex field(R"(  network: sent \d+.*, Unix time \+(\d+\.\d{6}) s \+-\d+\.\d\d us\n)");
  ASSERT_TRUE(std::regex_search(outcome.text, found, field)) << outcome.text;
  EXPECT_NEAR(std::stod(found[1]), offset.count(), 0.1);
  EXPECT_EQ(touchline(command).text.find("Unix time"), std::string::npos);
}

TEST_F(Program, PlaysARecordingAtTheBoardsRate) {
  // 30 pictures have 29 periods. A loaded machine may take longer, but never less.
  const auto duration_s = [this](const std::string& rate_hz) {
    const CommandOutput outcome = touchline("run --headless --set camera.rate_hz=" + rate_hz + " " + board());
    const std::string before = "frames    30 in ";
    const std::size_t at = outcome.text.find(before);
    EXPECT_NE(at, std::string::npos) << outcome.text;
    return at == std::string::npos ? 0.0 : std::stod(outcome.text.substr(at + before.size()));
  };
  EXPECT_GE(duration_s("20.0"), 1.4);
  EXPECT_GE(duration_s("0.0"), 0.9) << "pictures without their own rate are played at 30 Hz";
}

TEST_F(Program, TerminationStopsTheRobotsAndSucceeds) {
  // A recording of 30 s, ended after the first status line. The signal is sent twice, as timeout does.
  const std::string output = "'" + (folder_ / "output.txt").string() + "'";
  const std::string arguments = "run --headless --status-interval 0.1 --set camera.rate_hz=1.0 ";
  write("end.sh", "'" TOUCHLINE_PROGRAM "' " + arguments + board() + " >" + output + " 2>&1 & p=$!\n" +
                      "until grep -q latency " + output + " || ! kill -0 $p; do sleep 0.02; done\n" +
                      "kill -TERM $p; kill -TERM $p\nwait $p; code=$?\ncat " + output + "\nexit $code\n");
  const CommandOutput outcome = run_command("sh '" + (folder_ / "end.sh").string() + "' 2>&1");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("end       stopped on request\n"), std::string::npos) << outcome.text;
  const std::size_t stops = outcome.text.find(" of them stop packets");
  ASSERT_NE(stops, std::string::npos);
  EXPECT_GE(std::stoi(outcome.text.substr(outcome.text.rfind(' ', stops - 1))), 5) << outcome.text;
}

class BlockedTerminal : public Program {
 protected:
  // Runs the program with this terminal, sends SIGTERM when robots are driven, and expects that it stops them and ends.
  void expect_termination(int terminal) const {
    std::filesystem::create_directories(folder_ / "run");
    const std::string run_folder = (folder_ / "run").string(), board_file = (folder_ / "board.toml").string();
    const pid_t process = ::fork();
    if (process == 0) {
      ::setenv("RUNTIME_DIRECTORY", run_folder.c_str(), 1);
      for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(terminal, stream);
      ::execl(TOUCHLINE_PROGRAM, "touchline", "run", "--headless", "--status-interval", "0.05", "--board",
              board_file.c_str(), "--set", "camera.rate_hz=1.0", nullptr);
      ::_exit(127);
    }
    const std::filesystem::path marker = folder_ / "run/driving-robots";
    constexpr useconds_t kPause_us = 10'000;
    for (int i = 0; i < 3000 && !std::filesystem::exists(marker); ++i) ::usleep(kPause_us);
    ::usleep(10 * kPause_us);  // a status line or two
    EXPECT_EQ(testing::exit_code_after_termination(process, 20), 0) << "SIGTERM must end the program";
    EXPECT_FALSE(std::filesystem::exists(marker)) << "the loop must end as it does after its stop packets";
  }
};

TEST_F(BlockedTerminal, APipeThatNobodyReadsDoesNotHoldUpTheEnd) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
  ASSERT_EQ(::fcntl(ends[1], F_SETFL, O_NONBLOCK), 0);
  while (::write(ends[1], "full", 4) > 0) {
  }
  ASSERT_EQ(::fcntl(ends[1], F_SETFL, 0), 0);
  expect_termination(ends[1]);
  for (const int end : ends) ::close(end);
}

// This has the effect of Ctrl-S.
TEST_F(BlockedTerminal, AStoppedTerminalDoesNotHoldUpTheEnd) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_EQ(::grantpt(master), 0);
  ASSERT_EQ(::unlockpt(master), 0);
  const int terminal = ::open(::ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::tcflow(terminal, TCOOFF), 0);
  expect_termination(terminal);
  ::close(terminal);
  ::close(master);
}

// Robots must not drive by themselves after a crash and an automatic restart.
TEST_F(Program, AfterAnUnexpectedEndRobotsWaitForAStart) {
  std::filesystem::create_directories(folder_ / "run");
  const std::string marker = "'" + (folder_ / "run/driving-robots").string() + "'";
  const std::string service =
      "RUNTIME_DIRECTORY='" + (folder_ / "run").string() + "' '" TOUCHLINE_PROGRAM "' run --headless ";
  write("crash.sh", service + "--status-interval 0.1 --set camera.rate_hz=1.0 " + board() +
                        " >/dev/null 2>&1 & p=$!\n" + "for i in $(seq 500); do test -e " + marker +
                        " && break; sleep 0.02; done\nkill -KILL $p\nwait $p\n");
  static_cast<void>(run_command("sh '" + (folder_ / "crash.sh").string() + "' 2>&1"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/driving-robots"));
  const CommandOutput restarted = run_command(service + "--frames 7 " + board() + " 2>&1");
  EXPECT_EQ(restarted.code, 0) << restarted.text;
  EXPECT_NE(
      restarted.text.find("the previous run ended unexpectedly: robots are stopped until the service is restarted"),
      std::string::npos)
      << restarted.text;
  EXPECT_NE(restarted.text.find("packets   12 sent, 12 of them stop packets"), std::string::npos) << restarted.text;
  // That run ended normally, so robots move after the next start.
  const CommandOutput started = run_command(service + "--frames 7 " + board() + " 2>&1");
  EXPECT_NE(started.text.find("packets   12 sent, 5 of them stop packets"), std::string::npos) << started.text;
}

TEST_F(Program, AfterALostDeviceRobotsWaitForAStart) {
  std::filesystem::create_directories(folder_ / "run");
  const std::string service =
      "RUNTIME_DIRECTORY='" + (folder_ / "run").string() + "' '" TOUCHLINE_PROGRAM "' run --headless ";
  EXPECT_EQ(run_command(service + board() + "--frames 3 2>&1").code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run/driving-robots"));
  // A picture of another size is a fault.
  write("frames/15.ppm", "P6\n32 24\n255\n" + std::string(std::size_t{32} * 24 * 3, '\0'));
  EXPECT_EQ(run_command(service + board() + " 2>&1").code, 2);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/driving-robots"));
}

TEST_F(Program, ClosedStandardDescriptorsAreOpenedAsDevNull) {
  const std::string arguments = "run --headless --set camera.rate_hz=1.0 ";
  write("closed.sh",
        "'" TOUCHLINE_PROGRAM "' " + arguments + board() + " <&- >&- 2>&- & p=$!\n" +
            "for i in $(seq 250); do test \"$(readlink /proc/$p/fd/2)\" = /dev/null && break; sleep 0.02; done\n" +
            "readlink /proc/$p/fd/0 /proc/$p/fd/1 /proc/$p/fd/2\nexec 2>/dev/null\nkill -TERM $p\nwait $p\n");
  EXPECT_EQ(run_command("sh '" + (folder_ / "closed.sh").string() + "' 2>&1").text,
            "/dev/null\n/dev/null\n/dev/null\n");
}

// Sanitizers do not work with a memory limit.
#if !defined(TOUCHLINE_SANITIZED)
TEST_F(Program, AReloadWithoutMemoryDoesNotEndTheGame) {
  const std::string output = "'" + (folder_ / "output.txt").string() + "'";
  const std::string run =
      "'" TOUCHLINE_PROGRAM "' run --headless --set radio.backend=none --board '" TOUCHLINE_MOCK_BOARD "' ";
  write("reload.sh", run + ">" + output + " 2>&1 & p=$!\n" + "until grep -q latency " + output +
                         " || ! kill -0 $p; do sleep 0.02; done\n" +
                         "size=$(sed -n 's/VmSize:[^0-9]*\\([0-9]*\\).*/\\1/p' /proc/$p/status)\n" +
                         "prlimit --pid $p --as=$((size * 1024)):unlimited\nkill -HUP $p\nsleep 1\n" +
                         "prlimit --pid $p --as=unlimited\nkill -TERM $p\nwait $p; code=$?\ntail -n 25 " + output +
                         "\nexit $code\n");
  const CommandOutput outcome = run_command("sh '" + (folder_ / "reload.sh").string() + "' 2>&1");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("end       stopped on request\n"), std::string::npos) << outcome.text;
}
#endif

TEST_F(Program, FrameLimit) {
  const CommandOutput outcome = touchline("run --frames 7 " + board());
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("frames    7 in "), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace touchline::testing
