// Plays every row of docs/faults.md: robots drive, the fault is planted, its reason holds and packets stop the robots;
// when the end condition is met, they drive again. Errors after which the program ends do end it.
#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include "firmware/fault_policy.h"
#include "firmware/fault_reference.h"
#include "firmware/loop.h"
#include "hal/linux/monotonic_clock.h"
#include "tests/mock/mock_game.h"
#include "tests/results.h"

namespace touchline {
namespace {

using hal::mock::FaultKind;

/// Inputs that cannot be read while `fails` is set.
class UnreadableGpio final : public hal::Gpio {
 public:
  explicit UnreadableGpio(hal::Gpio& gpio) : gpio_(gpio) {}
  bool fails = false;

 private:
  Result<void> do_open() override { return gpio_.open(); }
  void do_close() override { gpio_.close(); }
  Result<hal::GpioInputs> do_inputs(Instant now) override {
    if (fails) return failure(ErrorCode::kIo, "planted");
    return gpio_.inputs(now);
  }
  Result<void> do_set_status_led(bool on) override { return gpio_.set_status_led(on); }
  Result<void> do_set_strobe(bool on) override { return gpio_.set_strobe(on); }

  hal::Gpio& gpio_;
};

/// A camera that fails with an error, also when it is opened again, while `error` is set.
class FailingCamera final : public hal::Camera {
 public:
  explicit FailingCamera(hal::Camera& camera) : camera_(camera) {}
  std::optional<ErrorCode> error;

  [[nodiscard]] const hal::CameraInfo& info() const override { return camera_.info(); }

 private:
  Result<void> do_open() override { return error ? Result<void>(failure(*error, "planted")) : camera_.open(); }
  Result<void> do_start() override { return camera_.start(); }
  Result<hal::FrameLease> do_wait(Instant deadline) override {
    Result<hal::FrameLease> frame = camera_.wait(deadline);
    if (error) return failure(*error, "planted");
    return frame;
  }
  void do_release(std::uint32_t) noexcept override {}  // leases are those of `camera_`
  void do_stop() override { camera_.stop(); }
  void do_close() override { camera_.close(); }

  hal::Camera& camera_;
};

/// The mock board's game, with a console and a referee.
struct FaultGame : public MockGame {
  explicit FaultGame(std::vector<hal::mock::ArenaFault> faults, const std::function<void(LoopSettings&)>& change)
      : MockGame(1, std::move(faults)), failing_camera(*camera), failing_gpio(*gpio) {
    LoopSettings changed = settings();
    changed.external.console = &console;
    changed.external.referee = &referee;
    if (change) change(changed);
    open(loop, failing_camera, *radio, failing_gpio, changed, LoopObserver{&FaultGame::observe, this});
    put();
  }

  /// Runs until `reached`, at most `for_s`. Returns whether it was reached.
  bool run_until(const std::function<bool()>& reached, double for_s) {
    for (const double end_s = now_s() + for_s; now_s() < end_s && !reached();) {
      if (loop->iterate().has_value()) return false;
    }
    return reached();
  }
  void put() { console.input.put(wanted); }
  void start() {
    wanted.stop = wanted.setup_ended = false;
    ++wanted.starts;
    wanted.start_number = console.held_number;
    if (wanted.driver_heard) wanted.driver_heard = hal::MonotonicClock::read();
    put();
  }
  void put(RefereeState state) {
    state.received = hal::MonotonicClock::read();
    referee.put(state);
  }

  ConsoleLink console;
  ConsoleInput wanted;
  Mailbox<RefereeState> referee;
  FailingCamera failing_camera;
  UnreadableGpio failing_gpio;
  std::optional<Loop> loop;
  bool drives = false;  // the last frame's packet

 private:
  static void observe(void* context, const StepTrace& trace, const StepTiming&) {
    static_cast<FaultGame*>(context)->drives = !trace.commands.stop;
  }
};

struct FaultScenario {
  std::vector<hal::mock::ArenaFault> faults{};
  std::function<void(LoopSettings&)> change{};
  std::function<void(FaultGame&)> plant{}, end{};
  bool holds_at_first = false;
};

const std::map<std::string, FaultScenario>& fault_scenarios() {
  // The arena's own faults begin at 2.5 s: a tile of the picture is judged after one to two seconds.
  const auto arena = [](FaultKind kind, double for_s, bool needs_start = false) {
    FaultScenario scenario{.faults = {{kind, 2.5, for_s}}};
    if (needs_start) scenario.end = [](FaultGame& game) { game.start(); };
    return scenario;
  };
  const auto console = [](auto set, auto end) {
    FaultScenario scenario;
    scenario.plant = [set](FaultGame& game) {
      set(game.wanted);
      game.put();
    };
    scenario.end = end;
    return scenario;
  };
  const auto referee_says = [](GamePhase phase, float own_height_m, bool repeats) {
    return [=](FaultGame& game) {
      RefereeState state;
      state.phase = phase;
      state.own_height_m = own_height_m;
      state.repeats = repeats;
      game.put(state);
    };
  };
  const auto start = [](FaultGame& game) { game.start(); };
  const auto held = [start](auto change) {
    return FaultScenario{.change = change, .end = start, .holds_at_first = true};
  };
  static const std::map<std::string, FaultScenario> scenarios{
      {"no_frames", arena(FaultKind::kCameraStall, 0.6)},
      {"repeats", arena(FaultKind::kPictureFrozen, 0.6)},
      {"overload", arena(FaultKind::kPictureRandom, 0.6)},
      {"field", arena(FaultKind::kDark, 0.6)},
      {"motion", arena(FaultKind::kPictureTurned, 0.6, true)},
      {"emergency", arena(FaultKind::kEmergencyStop, 0.6, true)},
      {"radio", arena(FaultKind::kRadioLost, 0.3)},
      {"unreadable_line",
       {.plant = [](FaultGame& game) { game.failing_gpio.fails = true; },
        .end =
            [](FaultGame& game) {
              game.failing_gpio.fails = false;
              game.run_until([&] { return (game.loop->halt() & kHaltUnreadableLine) == 0; }, 3.0);
              game.start();
            }}},
      {"start", held([](LoopSettings& settings) { settings.start_button = true; })},
      {"crash", held([](LoopSettings& settings) { settings.held.reasons = kHaltCrash; })},
      {"referee",
       {.plant = referee_says(GamePhase::kHalt, 0.0f, false), .end = referee_says(GamePhase::kRunning, 0.0f, false)}},
      {"silence",
       {.plant = referee_says(GamePhase::kRunning, 0.0f, true), .end = referee_says(GamePhase::kRunning, 0.0f, false)}},
      {"teams",
       {.plant = referee_says(GamePhase::kRunning, 1e6f, false),
        .end = referee_says(GamePhase::kRunning, 0.0f, false)}},
      {"console", console([](ConsoleInput& wanted) { wanted.stop = true; }, start)},
      {"setup_ended", console([](ConsoleInput& wanted) { wanted.stop = wanted.setup_ended = true; }, start)},
      {"driver",
       console(
           [](ConsoleInput& wanted) { wanted.driver_heard = hal::MonotonicClock::read() - std::chrono::seconds(2); },
           start)},
      {"setup", console([](ConsoleInput& wanted) { wanted.setup = SetupWish::kStand; },
                        [](FaultGame& game) {
                          game.wanted.setup = SetupWish::kNone;
                          game.put();
                        })}};
  return scenarios;
}

std::string read_fault_page() {
  std::ostringstream page;
  page << std::ifstream(TOUCHLINE_DOCS "/faults.md").rdbuf();
  return page.str();
}

/// Words of the first table: "| `word` | ...".
std::set<std::string> words_of_fault_page() {
  std::set<std::string> words;
  std::istringstream lines(read_fault_page());
  for (std::string line; std::getline(lines, line) && !line.starts_with("## Errors");) {
    if (line.starts_with("| `")) words.insert(line.substr(3, line.find('`', 3) - 3));
  }
  return words;
}

TEST(FaultTable, ThePageIsWhatTheProgramPrints) {
  const std::string page = read_fault_page();
  ASSERT_FALSE(page.empty());
  const Result<std::string> updated = updated_fault_reference(page);
  ASSERT_OK(updated);
  EXPECT_EQ(page, updated.value()) << "touchline faults --update docs/faults.md";
}

TEST(FaultTable, EveryRowIsPlayed) {
  std::set<std::string> played;
  for (const auto& [word, scenario] : fault_scenarios()) played.insert(word);
  EXPECT_EQ(words_of_fault_page(), played);
}

class FaultRow : public ::testing::TestWithParam<std::string> {};

TEST_P(FaultRow, StopsTheRobotsAndEnds) {
  const FaultScenario& scenario = fault_scenarios().at(GetParam());
  const auto* const description = std::find_if(kHaltDescriptions.begin(), kHaltDescriptions.end(),
                                               [](const HaltDescription& halt) { return halt.word == GetParam(); });
  ASSERT_NE(description, kHaltDescriptions.end());
  FaultGame game(scenario.faults, scenario.change);
  const auto drives = [&] { return game.drives && game.loop->halt() == kHaltNone; };
  if (!scenario.holds_at_first) {
    ASSERT_TRUE(game.run_until(drives, 2.0)) << "before the fault";
    game.run_until([&] { return game.now_s() >= 2.45; }, 3.0);
    EXPECT_TRUE(drives());
    if (scenario.plant) scenario.plant(game);
  }
  ASSERT_TRUE(game.run_until([&] { return (game.loop->halt() & description->bit) != 0; }, 3.0));
  // Robots stop at most one frame later, unless there are no frames.
  const std::uint64_t frames = game.loop->statistics().frames;
  game.run_until([&] { return game.loop->statistics().frames > frames; }, 0.1);
  EXPECT_TRUE(!game.drives || GetParam() == "no_frames");
  if (!scenario.faults.empty()) game.run_until([&] { return game.now_s() >= 3.3; }, 2.0);
  if (scenario.end) {
    EXPECT_FALSE(game.run_until(drives, 0.3)) << "it must not end by itself";
    scenario.end(game);
  }
  EXPECT_TRUE(game.run_until(drives, 3.0)) << "after what ends it; halt " << game.loop->halt();
}

std::vector<std::string> played_faults() {
  std::vector<std::string> words;
  for (const auto& [word, scenario] : fault_scenarios()) words.push_back(word);
  return words;
}
INSTANTIATE_TEST_SUITE_P(, FaultRow, ::testing::ValuesIn(played_faults()), [](const auto& test) { return test.param; });

class ErrorRow : public ::testing::TestWithParam<ErrorDescription> {};

// The second table, with the camera's errors. An error of the radio is the row `radio`, one of the GPIO chip
// `unreadable_line`.
TEST_P(ErrorRow, StopsTheRobotsAndEnds) {
  const ErrorCode code = GetParam().code;
  const std::string name = describe(code);
  EXPECT_NE(read_fault_page().find("| `" + name + "` | " + std::string(GetParam().seen)), std::string::npos);
  FaultGame game({}, {});
  const auto drives = [&] { return game.drives && game.loop->halt() == kHaltNone; };
  ASSERT_TRUE(game.run_until(drives, 2.0)) << "before the error";
  game.failing_camera.error = code;
  if (action_for(code) == FaultAction::kLeave) {
    std::optional<LoopEnd> end;
    for (const double until_s = game.now_s() + 1.0; game.now_s() < until_s && !end;) end = game.loop->iterate();
    EXPECT_TRUE(end.has_value());
    return;
  }
  if (action_for(code) == FaultAction::kSkip) {
    // A lost frame stops nobody.
    const double begin_s = game.now_s();
    EXPECT_TRUE(game.run_until([&] { return game.now_s() > begin_s + 0.03; }, 0.2));
    EXPECT_EQ(game.loop->halt(), kHaltNone);
  }
  EXPECT_TRUE(game.run_until([&] { return (game.loop->halt() & kHaltNoFrames) != 0; }, 1.0));
  EXPECT_FALSE(game.run_until(drives, 0.3)) << "it must not end by itself";
  game.failing_camera.error.reset();
  EXPECT_TRUE(game.run_until(drives, 5.0)) << "after what ends it; halt " << game.loop->halt();
}

INSTANTIATE_TEST_SUITE_P(, ErrorRow, ::testing::ValuesIn(kErrorDescriptions), [](const auto& test) {
  std::string name(describe(test.param.code));
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
});

}  // namespace
}  // namespace touchline
