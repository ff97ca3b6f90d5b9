#include "firmware/command_line.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <cstdio>
#include <string>

#include "firmware/config/standard_layouts.h"
#include "firmware/config/user_files.h"
#include "firmware/config/wording.h"
#include "firmware/parse_arguments.h"

namespace touchline {
namespace {

constexpr const char* kDescription =
    "Watches a robot-soccer field from above and drives the robots by radio:\n"
    "camera frame in, radio packet out, on time.";

constexpr const char* kNotes =
    "Exit codes: 0 success, 1 the configuration is wrong, 2 a device failed, 64 the command line is wrong, 70 an\n"
    "internal error.\n"
    "No device is opened before all files are checked. Ctrl-C stops the robots and ends the program; pressed again\n"
    "after a second, it ends the program immediately.\n"
    "SIGUSR1 freezes the adaptation to the light or resumes it, SIGUSR2 resets it to the calibration or restarts it.\n"
    "SIGHUP reloads the files: exposure, gain, thresholds, light map, limits of the control and times change while\n"
    "robots play; keys that need a restart are listed. (After the terminal was closed, SIGHUP ends the program.)";

// Replaces CLI11's ranges, which accept "nan" and print the largest double as a limit.
CLI::Validator between(double low, double high) {
  std::array<char, 64> range{};
  std::snprintf(range.data(), range.size(), "%g to %g", low, high);
  const std::string name = range.data();
  return {[low, high, name](std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
            return good ? std::string() : text + " is out of range: " + name;
          },
          name};
}

void add_files(CLI::App& app, config::FilePaths& files) {
  app.add_option("--board", files.board,
                 "Board file: devices, real-time settings, faults. Default: board.toml in this folder, in\n"
                 "~/.config/touchline or in /etc/touchline")
      ->type_name("FILE");
  app.add_option("--venue", files.venue, "Venue file; default: the one in the board file")->type_name("FILE");
  app.add_option("--team", files.team, "Team file; default: the one in the board file")->type_name("FILE");
  app.add_option("--set", files.overrides,
                 "Override a key of one of the three files: --set camera.exposure_us=4000. KEY+=LIST adds to a list.\n"
                 "`touchline keys` lists all keys")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
}

void add_network(CLI::App& app, network::NetworkOptions& network) {
  const auto add = [&app](const char* name, std::vector<std::string>& texts, const auto& protocols, const char* type,
                          const char* help) {
    const std::vector<std::string_view> words = config::words_of(protocols);
    app.add_option(name, texts, help)
        ->type_name(choice_name({words.begin(), words.end()}) + type)
        ->expected(1)
        ->take_all();
  };
  add("--publish", network.publish, config::kOutputProtocols, "[=ADDRESS]",
      "Send what is seen to other programs: ssl-vision, ssl-tracked, firasim or json, and the robots' places to the\n"
      "VSSS referee: vsss-placement; several times if needed.\n"
      "ADDRESS: udp://ADDRESS:PORT[%INTERFACE]; for json also unix:///PATH. Default: the protocol's usual address");
  add("--accept", network.accept, network::kCommandWords, "[=ADDRESS][,from=SENDER...]",
      "Let programs drive robots: firasim or json. Those of this computer may; SENDER permits others: an address or a\n"
      "network, such as 192.168.1.20 or 192.168.1.0/24");
  add("--referee", network.referee, network::kRefereeWords, "[=ADDRESS][,from=SENDER...]",
      "Obey a referee: ssl or vsss. SENDER permits its computer; programs of this computer are permitted");
}

}  // namespace

std::optional<int> parse_command_line(int argc, char** argv, CommandLine& out) {
  CLI::App app(kDescription, "touchline");
  add_examples(app,
               {{"touchline init --league vsss --out hall", "write files to start from"},
                {"touchline check --board hall/board.toml", "find mistakes in the files"},
                {"touchline run --board hall/board.toml", "play"},
                {"touchline keys exposure", "explain the keys about exposure"}},
               kNotes);
  app.require_subcommand(1);

  double duration_s = 0.0, interval_s = 1.0;
  CLI::App* run = app.add_subcommand("run", "Observe the field and drive the robots until interrupted");
  add_files(*run, out.session.files);
  run->add_option("--frames", out.session.frames, "End after this number of frames")->check(between(1.0, 1e12));
  run->add_option("--duration", duration_s, "End after this number of seconds (of simulated time in the mock arena)")
      ->check(between(0.001, 1e8));
  run->add_option("--seed", out.session.seed,
                  "Seed of all random numbers of the mock arena; the same seed gives the same run to the bit")
      ->check(between(0.0, 1.8446744073709552e19))
      ->capture_default_str();
  run->add_flag("--headless", out.headless,
                "Print status lines instead of a map of the field. Without --pace and without connections to other\n"
                "programs, the mock arena then runs as fast as possible");
  add_network(*run, out.network);
  CLI::Option* const console =
      run->add_option(
             "--console", out.console.address,
             "Serve the console, the page in a browser, at this address. Default: [console] of the board file,\n"
             "127.0.0.1:8642. Port 0: a free one, which is printed")
          ->type_name("ADDRESS:PORT")
          ->expected(0, 1);
  run->add_flag(
         "--lan", out.console.is_for_network,
         "Serve the console to other computers and phones too, at port 8642 or the next free one, and print login\n"
         "links. It is the same as --console 0.0.0.0:8642")
      ->excludes(console);
  run->add_option("--record", out.recordings,
                  "Record the run into a new file in this folder, for touchline-replay and Foxglove. Default:\n"
                  "recording.folder of the board file")
      ->type_name("FOLDER");
  std::string pace;
  run->add_option(
         "--pace", pace,
         "Speed of the mock arena: real (default if a map is shown, anything is published or accepted, or with\n"
         "--console) or fast. The console of the board file is not served while the arena runs fast")
      ->check(one_of({"real", "fast"}));
  run->add_option("--status-interval", interval_s, "Seconds between two status lines")
      ->check(between(0.05, 3600.0))
      ->capture_default_str();
  add_examples(
      *run,
      {{"touchline run --board boards/mock/board.toml", "play in the built-in arena"},
       {"touchline run --board board.toml --set camera.exposure_us=4000", "with another exposure for this time"},
       {"touchline run --board board.toml --publish ssl-vision --referee ssl", "with programs of a league"},
       {"touchline run --board board.toml --record games", "record the game into a file in the folder games"},
       {"touchline run --board boards/mock/board.toml --headless --duration 30 --seed 1",
        "30 s of the arena as fast as possible; the same seed gives the same game"}},
      kNotes);

  CLI::App* check = app.add_subcommand("check",
                                       "Read the three files, print all errors in them and what would be sent where,\n"
                                       "and open no device");
  add_files(*check, out.session.files);
  add_network(*check, out.network);
  check->add_flag("--dump", out.dump, "Print the values of all keys, defaults included, with their meaning");
  add_examples(
      *check,
      {{"touchline check --board board.toml", "find mistakes in the files"},
       {"touchline check --board board.toml --dump", "print the value of every key"},
       {"touchline check --board board.toml --draw layout.png", "see the robots as the team file describes them"}},
      "Exit codes: 0 the files are valid, 1 they have errors, 64 the command line is wrong.");

  check->add_option("--draw", out.drawing, "Draw the robots' tops as the team file describes them, into this PNG file")
      ->type_name("FILE");

  CLI::App* init =
      app.add_subcommand("init", "Write board, venue and team files to start from, and print the next steps");
  init->add_option("--league", out.init.league, "League whose field, robots and colors the files describe")
      ->required()
      ->check(one_of(init_leagues()));
  init->add_option("--out", out.init.folder, "Folder of the files")->type_name("DIR")->capture_default_str();
  init->add_flag("--force", out.init.force, "Replace files that exist already");
  std::string layouts = "Layouts that team files can name (own ones are declared with [[layout]]):\n";
  for (const config::StandardLayout& layout : config::standard_layouts()) {
    layouts += "  " + std::string(layout.name) + ": " + std::string(layout.help) + "\n";
  }
  add_examples(*init,
               {{"touchline init --league mirosot", "write the files into this folder"},
                {"touchline init --league vsss --out hall", "write them into the folder hall"}},
               layouts);

  CLI::App* keys = app.add_subcommand("keys", "List keys of the three files: type, range, default, meaning");
  CLI::Option* words = keys->add_option(
      "words", out.key_words, "Only keys that have each of these words in their file, section, name or meaning");
  keys->add_option("--update", out.page_to_update, "Write the reference into this page (docs/files.md) instead")
      ->excludes(words)
      ->type_name("FILE");
  add_examples(*keys,
               {{"touchline keys", "list all keys"},
                {"touchline keys exposure", "list the keys about exposure"},
                {"touchline keys camera gain", "list the camera's keys about gain"},
                {"touchline keys team.toml", "list the keys of the team file"}},
               "Exit codes: 0 success, 1 no key has all words, 64 the command line is wrong.");

  CLI::App* faults = app.add_subcommand("faults", "List all faults: what you see, what robots do, how it ends");
  faults->add_option("--update", out.page_to_update, "Write the tables into this page (docs/faults.md) instead")
      ->type_name("FILE");

  add_examples(*faults, {{"touchline faults", "print the tables"},
                         {"touchline faults --update docs/faults.md", "write them into the documentation"}});

  CLI::App* radio = app.add_subcommand("radio", "List what robots can understand, or print one of these formats");
  radio->add_option("format", out.radio_format, "Print the keys of this format, to copy them into a team file");
  add_examples(*radio, {{"touchline radio", "list the formats"}, {"touchline radio sysmic", "print one of them"}});

  CLI::App* console_command = app.add_subcommand("console", "Show what a browser on another computer needs");
  add_files(*console_command, out.session.files);
  bool prints_token = false;
  CLI::Option* const token =
      console_command->add_flag("--token", prints_token, "Print the token, and make it if there is none");
  console_command
      ->add_flag("--link", out.prints_login_link, "Print the links with which other computers log in, and a QR code")
      ->excludes(token);
  add_examples(*console_command, {{"touchline console --link", "print login links and a QR code"},
                                  {"sudo -u touchline touchline console --token", "print the token of the service"}});

  CLI::App* link = app.add_subcommand(
      "link",
      "Open the installed service's page to the computers and phones of the local network, and print login\n"
      "links. Restarts the service, which stops the robots");
  link->add_flag("--undo", out.link.is_undone, "Close the page again");
  add_examples(*link, {{"sudo touchline link", "open the page of this board"},
                       {"sudo touchline link --undo", "close it again"}});

  if (const std::optional<int> exit_code = parse_arguments(app, argc, argv)) return exit_code;
  if (console_command->parsed() && !prints_token && !out.prints_login_link) {
    std::fputs("touchline: console: --token or --link is required\nRun with --help for more information.\n", stderr);
    return kExitBadCommandLine;
  }
  out.command = init->parsed()              ? Command::kInit
                : check->parsed()           ? Command::kCheck
                : keys->parsed()            ? Command::kKeys
                : faults->parsed()          ? Command::kFaults
                : console_command->parsed() ? Command::kConsole
                : link->parsed()            ? Command::kLink
                : radio->parsed()           ? Command::kRadio
                                            : Command::kRun;
  out.console.is_requested = console->count() > 0 || out.console.is_for_network;
  if (out.console.is_for_network) out.console.address = "0.0.0.0:8642";
  const bool needs_board = out.command == Command::kRun || out.command == Command::kCheck;
  if (out.session.files.board.empty()) {
    const Result<std::string> found = config::find_board_file();
    if (!found.ok() && needs_board) {
      std::fprintf(stderr, "touchline: %s\n", found.error().text.c_str());
      return kExitBadFile;
    }
    if (found.ok()) out.session.files.board = found.value();
  }
  if (!pace.empty()) out.pace = pace == "real" ? Pace::kReal : Pace::kFast;
  out.session.duration = from_seconds(duration_s);
  out.session.status_interval = from_seconds(interval_s);
  return std::nullopt;
}

}  // namespace touchline
