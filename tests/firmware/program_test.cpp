// The program touchline as a person or a script calls it: command line, check, init and keys.
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/firmware/program_fixture.h"

namespace touchline::testing {
namespace {

std::string read(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

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
  expect_first_line("play",
                    "\"play\" is no command; known commands: run, check, init, keys, faults, radio, console, link");
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
    // The calibration would correct the only errors.
    const CommandOutput checked = touchline("check --board '" + board + "'");
    EXPECT_EQ(checked.code, 1);
    const std::string where = folder + "/venue.toml", next = where + " is not calibrated yet. Next steps: ";
    EXPECT_EQ(checked.text.find(where + ": picture: is missing\n" + where + ": camera_model: is missing\n" + where +
                                ": colors: is missing\n" + next),
              0U)
        << checked.text;
    // A drawing needs no calibration.
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

}  // namespace
}  // namespace touchline::testing
