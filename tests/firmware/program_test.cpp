// The program touchline as a person or a script calls it: exit codes and output.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "tests/command_output.h"

namespace touchline {
namespace {

using testing::CommandOutput;
using testing::run_command;

// The text has standard output and error.
CommandOutput touchline(const std::string& arguments) {
  return run_command("'" TOUCHLINE_PROGRAM "' " + arguments + " 2>&1");
}

std::string read(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Program : public ::testing::Test {
 protected:
  Program() : folder_(std::filesystem::temp_directory_path() / ("touchline-program-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    write("venue.toml",
          "version = 1\n[picture]\nwidth_px = 64\nheight_px = 48\n[field]\nlength_m = 2.2\nwidth_m = 1.8\n"
          "[camera_model]\nkind = \"full\"\n[camera_model.full]\nfx_px = 60.0\nfy_px = 60.0\ncx_px = 31.5\n"
          "cy_px = 23.5\nrotation_rad = [3.14159, 0.0, 0.0]\nposition_m = [0.0, 0.0, 2.0]\n[colors]\nspace = \"rgb\"\n"
          "[[color]]\nname = \"orange\"\n[[color.box]]\nlow = [200, 100, 0]\nhigh = [255, 160, 60]\n"
          "[[color]]\nname = \"blue\"\n[[color.box]]\nlow = [0, 0, 200]\nhigh = [60, 60, 255]\n"
          "[[color]]\nname = \"red\"\n[[color.box]]\nlow = [200, 0, 0]\nhigh = [255, 60, 60]\n");
    write("team.toml",
          "version = 1\n[own]\ncolor = \"blue\"\n[[own.robot]]\nid = 0\ncolors = [\"red\"]\n[ball]\ncolor = "
          "\"orange\"\n");
    std::filesystem::create_directories(folder_ / "frames");
    for (int i = 0; i < 30; ++i) {
      write("frames/" + std::to_string(i) + ".ppm", "P6\n64 48\n255\n" + std::string(std::size_t{64} * 48 * 3, '\0'));
    }
    write_board("replay", "frames");
  }
  ~Program() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void write_board(const std::string& backend, const std::string& device) const {
    write("board.toml",
          "version = 1\nvenue = \"venue.toml\"\nteam = \"team.toml\"\n[camera]\nbackend = \"" + backend +
              "\"\ndevice = \"" + (folder_ / device).string() +
              "\"\nformat = \"rgb24\"\nwidth_px = 64\nheight_px = 48\nrate_hz = 30.0\n[radio]\nbackend = \"none\"\n");
  }
  [[nodiscard]] std::string board() const { return "--board '" + (folder_ / "board.toml").string() + "' "; }

  std::filesystem::path folder_;
};

TEST_F(Program, HelpAndVersionSucceed) {
  EXPECT_EQ(touchline("--help").code, 0);
  EXPECT_NE(touchline("run --help").text.find("--headless"), std::string::npos);
  EXPECT_EQ(touchline("--version").text, "touchline " TOUCHLINE_VERSION "\n");
}

TEST_F(Program, OutputThatCannotBeWrittenIsAnError) {
  for (const std::string& command : {std::string("keys"), "check --dump " + board(), "check " + board()}) {
    const CommandOutput outcome = run_command("{ '" TOUCHLINE_PROGRAM "' " + command + " >/dev/full; } 2>&1");
    EXPECT_EQ(outcome.code, 1) << command;
    EXPECT_EQ(outcome.text, "touchline: standard output: cannot be written: No space left on device\n") << command;
  }
}

TEST_F(Program, RejectsFilesThatAreNotRegularFiles) {
  const auto refused = [&](const std::string& path, const std::string& message) {
    const CommandOutput outcome = run_command("timeout 10 '" TOUCHLINE_PROGRAM "' check --board '" + path + "' 2>&1");
    EXPECT_EQ(outcome.code, 1) << path;
    EXPECT_EQ(outcome.text, path + ": " + message + "\n");
  };
  refused("/dev/zero", "is a character device, not a file");
  const std::string fifo = (folder_ / "fifo").string(), loop = (folder_ / "loop").string();
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  refused(fifo, "is a FIFO, not a file");
  std::filesystem::create_symlink("loop", loop);
  refused(loop, "its symbolic links form a loop");
  const std::string large = (folder_ / "large").string();
  write("large", "");
  std::filesystem::resize_file(large, std::uintmax_t{1} << 40);
  refused(large, "is larger than 1 MiB, the limit for such a file");
}

TEST_F(Program, AWrongCommandLineGivesExitCode64) {
  EXPECT_EQ(touchline("").code, 64);
  EXPECT_EQ(touchline("play").code, 64);
  EXPECT_EQ(touchline("init").code, 64);
  EXPECT_EQ(touchline("run " + board() + "--frames -1").code, 64);
  EXPECT_EQ(touchline("run " + board() + "--sed 1").code, 64);
  EXPECT_EQ(touchline("run " + board() + "--duration nan").code, 64);
  EXPECT_EQ(touchline("run " + board() + "--seed -1").code, 64);
  const CommandOutput endless = touchline("run " + board() + "--duration 1e300");
  EXPECT_EQ(endless.code, 64);
  EXPECT_NE(endless.text.find("--duration: 1e300 is out of range: 0.001 to 1e+08\n"), std::string::npos)
      << endless.text;
}

TEST_F(Program, AWrongWordIsNamedBeforeWhatIsMissingBecauseOfIt) {
  const auto expect_first_line = [](const std::string& arguments, const std::string& line) {
    const CommandOutput outcome = touchline(arguments);
    EXPECT_EQ(outcome.code, 64);
    EXPECT_EQ(outcome.text.substr(0, outcome.text.find('\n')), "touchline: " + line) << arguments;
  };
  expect_first_line("runn --board b.toml", "\"runn\" is no command; did you mean \"run\"?");
  expect_first_line("run --bord b.toml", "run: \"--bord\" is no option; did you mean \"--board\"?");
  expect_first_line("run --bord=b.toml", "run: \"--bord\" is no option; did you mean \"--board\"?");
  expect_first_line("run --board b.toml --sede 1", "run: \"--sede\" is no option; did you mean \"--seed\"?");
  expect_first_line("play", "\"play\" is no command; known commands: run, check, init, keys, faults, console, link");
  expect_first_line("check --board b.toml --headless",
                    "check: \"--headless\" is no option here, but one of touchline run");
  expect_first_line("init vsss", "init: \"vsss\" is one word too many");
  expect_first_line("--bord b.toml run", "run: \"--bord\" is no option; did you mean \"--board\"?");
  EXPECT_EQ(touchline("init").text.substr(0, 21), "--league is required\n") << "nothing is wrong but missing";
}

TEST_F(Program, CheckRefusesWhatNoCameraCanDo) {
  const auto expect_refused = [this](const std::string& settings, const std::string& message) {
    const CommandOutput outcome = touchline("check " + board() + settings);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.text.find(message), std::string::npos) << outcome.text;
  };
  expect_refused(
      "--set camera.exposure_us=5",
      "camera.exposure_us: 5 us is shorter than any camera exposes; it is 0 (not set) or at least 10 us: 1 ms "
      "is 1000 us\n");
  expect_refused("--set camera.exposure_us=50000 --set camera.backend=v4l2",
                 "camera.exposure_us: 50000 us is longer than a picture at rate_hz = 30.0 takes, 33333 us\n");
  expect_refused("--set camera.white_balance_k=46", "camera.white_balance_k: 46 K is no light");
  EXPECT_EQ(touchline("check " + board() + "--set camera.exposure_us=0 --set camera.white_balance_k=0").code, 0);
}

TEST_F(Program, CheckReportsWhetherFilesAreValid) {
  const CommandOutput sound = touchline("check " + board());
  EXPECT_EQ(sound.code, 0) << sound.text;
  EXPECT_NE(sound.text.find("are valid\n"), std::string::npos);
  EXPECT_EQ(sound.text.find("fastest kernel"), std::string::npos) << "the actual kernel must be named";
  const CommandOutput portable = touchline("check " + board() + "--set scan.kernel=portable");
  EXPECT_NE(portable.text.find("colors: portable kernel\n"), std::string::npos) << portable.text;
  const CommandOutput wrong = touchline("check " + board() + "--set camera.gain=-1 --set ball.radius_m=9");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.text.find("--set camera.gain=-1: camera.gain: -1 is out of range: 0 to 65535\n"), std::string::npos)
      << wrong.text;
  EXPECT_NE(wrong.text.find("ball.radius_m: 9 is out of range: 0.005 to 0.2 m\n"), std::string::npos) << wrong.text;
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

// The only place that states the hash of a game. It covers the whole way from rendered picture to wheels.
TEST_F(Program, AGameInTheArenaKeepsItsHash) {
  constexpr const char* kHash = "0c56830ad86b5637";
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

TEST_F(Program, KeysCommandFiltersByWords) {
  const CommandOutput found = touchline("keys camera exposure_us");
  EXPECT_EQ(found.code, 0);
  EXPECT_TRUE(found.text.starts_with("board.toml\n  camera.exposure_us: ")) << found.text;
  const CommandOutput unknown = touchline("keys exposre");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_EQ(unknown.text,
            "touchline: no key has \"exposre\" in its file, section, name or meaning; did you mean \"exposure\"?\n");
  EXPECT_EQ(touchline("keys camera --update x.md").code, 64);
}

TEST_F(Program, CheckOpensNoDevice) {
  write_board("v4l2", "there-is-no-such-camera");
  EXPECT_EQ(touchline("check " + board()).code, 0);
}

TEST_F(Program, CheckConfiguresTheStages) {
  const CommandOutput refused = touchline("check " + board() + "--set camera_model.full.fx_px=0.0");
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.text.find("camera_model.full.fx_px: must be above 0"), std::string::npos) << refused.text;
}

TEST_F(Program, InitWritesFilesThatOnlyLackTheCalibration) {
  for (const auto& [league, area_depth] :
       {std::pair<std::string, std::string>{"vsss", "0.15"}, {"mirosot", "0.35"}, {"ssl", "1.0"}}) {
    const std::string folder = (folder_ / league).string(), board = folder + "/board.toml",
                      picture = folder + "/layout.png";
    const CommandOutput made = touchline("init --league " + league + " --out '" + folder + "'");
    ASSERT_EQ(made.code, 0) << made.text;
    EXPECT_NE(made.text.find("touchline-calibrate field --venue " + folder + "/venue.toml"), std::string::npos)
        << made.text;
    // The only errors are those that the calibration mends.
    const CommandOutput checked = touchline("check --board '" + board + "'");
    EXPECT_EQ(checked.code, 1);
    const std::string where = folder + "/venue.toml", next = where + " is not calibrated yet. Next steps: ";
    EXPECT_EQ(checked.text.find(where + ": picture: is missing\n" + where + ": camera_model: is missing\n" + where +
                                ": colors: is missing\n" + next),
              0U)
        << checked.text;
    // A drawing needs none of that.
    const CommandOutput drawn = touchline("check --board '" + board + "' --draw '" + picture + "'");
    EXPECT_EQ(drawn.code, 0);
    EXPECT_EQ(drawn.text.find("the robots' tops of " + folder + "/team.toml are drawn in " + picture + "\n" + next), 0U)
        << drawn.text;
    EXPECT_GT(std::filesystem::file_size(picture), 1000U);
    EXPECT_NE(read(folder + "/venue.toml").find("\npenalty_area_depth_m = " + area_depth + "\n"), std::string::npos);

    std::ofstream(board, std::ios::app) << "# edited\n";
    const CommandOutput refused = touchline("init --league " + league + " --out '" + folder + "'");
    EXPECT_EQ(refused.code, 1);
    EXPECT_NE(refused.text.find("exists already; --force replaces it"), std::string::npos) << refused.text;
    const auto is_edited = [&] { return read(board).find("# edited") != std::string::npos; };
    EXPECT_TRUE(is_edited());
    EXPECT_EQ(touchline("init --force --league " + league + " --out '" + folder + "'").code, 0);
    EXPECT_FALSE(is_edited());
  }
  EXPECT_EQ(touchline("init --league chess").code, 64);
  EXPECT_NE(touchline("init --help").text.find("mirosot-triangles: "), std::string::npos);
}

// With the console a board without calibration runs, to be set up there. A path on the command line is no such board.
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

TEST_F(Program, TeamsNameStandardLayouts) {
  for (const auto& [layout, colors] :
       {std::pair{"vsss-halves", R"("red")"}, std::pair{"vsss-bar", R"("red", "orange")"},
        std::pair{"ssl-butterfly", R"("red", "red", "orange", "red")"}}) {
    write("team.toml", std::string("version = 1\n[own]\nlayout = \"") + layout +
                           "\"\nheight_m = 0.05\ncolor = \"blue\"\n[[own.robot]]\nid = 0\ncolors = [" + colors + "]\n");
    const CommandOutput sound = touchline("check " + board());
    EXPECT_EQ(sound.code, 0) << layout << ": " << sound.text;
  }
  write("team.toml",
        "version = 1\n[own]\nlayout = \"vsss-bars\"\ncolor = \"blue\"\n[[own.robot]]\nid = 0\ncolors = [\"red\"]\n");
  EXPECT_NE(touchline("check " + board()).text.find("vsss-bar"), std::string::npos);
}

TEST_F(Program, DumpShowsAllValuesInUse) {
  const CommandOutput dump = touchline("check --dump " + board() + "--set faults.stop_after_s=0.35");
  EXPECT_EQ(dump.code, 0);
  EXPECT_NE(dump.text.find("stop_after_s = 0.35 "), std::string::npos);
  EXPECT_NE(dump.text.find("baud = 115200 "), std::string::npos);
}

TEST_F(Program, KeysCommandListsKeys) {
  const CommandOutput keys = touchline("keys");
  EXPECT_EQ(keys.code, 0);
  EXPECT_NE(keys.text.find("  camera.exposure_us: integer, 0 to 1000000 us, default 5000, reload: camera\n"),
            std::string::npos);
  EXPECT_NE(keys.text.find("  color[].box[].low: list of 3 integers, 0 to 255, required, reload: thresholds\n"),
            std::string::npos);
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
  // 30 pictures, 29 periods. A loaded machine may take longer, but never less.
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
    ::kill(process, SIGTERM);
    int status = 0;
    bool ended = false;
    for (int i = 0; i < 2000 && !ended; ++i) {
      ended = ::waitpid(process, &status, WNOHANG) == process;
      if (!ended) ::usleep(kPause_us);
    }
    EXPECT_TRUE(ended) << "SIGTERM must end the program";
    if (!ended) {
      ::kill(process, SIGKILL);
      ::waitpid(process, &status, 0);
    }
    EXPECT_EQ(status, 0);
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

// As Ctrl-S does.
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
  // That run ended properly, so robots move after the next start.
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
}  // namespace touchline
