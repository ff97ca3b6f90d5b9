#include "tools/programs/simulate/game_video.h"

#include <algorithm>
#include <cmath>

#include "core/control/play_table.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/replay/picture_output.h"
#include "tools/programs/simulate/game_picture.h"

namespace touchline::simulate {
namespace {

using hal::mock::GameStatistics;
using hal::mock::Side;
using hal::mock::World;

// A fast ball crosses the field in this time, so that its whole way can be seen.
constexpr double kTrailS = 1.2;
// A viewer needs about a second to read two words.
constexpr double kEventS = 1.2;

const char* name_of(PlayRole role) {
  switch (role) {
    case PlayRole::kNone:
      break;
    case PlayRole::kGoalkeeper:
      return "goalkeeper";
    case PlayRole::kAttacker:
      return "attacker";
    case PlayRole::kSupporter:
      return "supporter";
  }
  return "";
}

const PlayDecision* decision_of(const Strategy& strategy, RobotId id) {
  const PlayDecisions* const decided = strategy.decisions();
  if (decided == nullptr) return nullptr;
  const auto* const found =
      std::find_if(decided->begin(), decided->end(), [id](const PlayDecision& decision) { return decision.id == id; });
  return found != decided->end() ? found : nullptr;
}

// Strategies that do not tell their decisions show the role.
std::string label_of(const PlayDecision* decision, PlayRole role) {
  if (decision == nullptr || decision->skill_line >= skill_table().size()) return name_of(role);
  std::string skill = skill_table()[decision->skill_line].name;
  if (decision->job_line >= job_table().size()) return skill;
  const std::string job = job_table()[decision->job_line].name;
  return job == skill ? job : job + ": " + skill;
}

// Follows a game from picture to picture.
class Viewer {
 public:
  Viewer(const TeamGame& game, const Team& own, const Team& opponent, double rate_hz)
      : game_(game), places_(static_cast<std::size_t>(std::max(2.0, kTrailS * rate_hz))) {
    shown_.teams = {own.name, opponent.name};
  }

  const ShownGame& look() {
    const hal::mock::Game& game = game_.game();
    const GameStatistics& statistics = game.statistics();
    shown_.time_s = game_.time_s();
    shown_.score = {statistics.goals_own, statistics.goals_opponent};
    note_event(statistics);
    const double held = statistics.possession_s[0] + statistics.possession_s[1];
    for (std::size_t i = 0; i < 2; ++i) {
      const double share = held > 0.0 ? statistics.possession_s[i] / held : 0.5;
      shown_.notes[i] = formatted("possession %.0f %%, touches %llu", 100.0 * share,
                                  static_cast<unsigned long long>(statistics.touches[i]));
    }
    list_robots(game.world());
    follow_ball(game);
    return shown_;
  }

 private:
  void note_event(const GameStatistics& now) {
    std::string event;
    if (now.goals_own != before_.goals_own) event = "goal: " + shown_.teams[0];
    if (now.goals_opponent != before_.goals_opponent) event = "goal: " + shown_.teams[1];
    if (now.free_balls != before_.free_balls) event = "free ball";
    if (now.restarts[index_of(Restart::kPenalty)] != before_.restarts[index_of(Restart::kPenalty)]) event = "penalty";
    if (now.restarts[index_of(Restart::kGoalKick)] != before_.restarts[index_of(Restart::kGoalKick)]) {
      event = "goal kick";
    }
    before_ = now;
    if (!event.empty()) {
      shown_.event = event;
      event_until_s_ = shown_.time_s + kEventS;
    } else if (shown_.time_s > event_until_s_) {
      shown_.event.clear();
    }
  }

  void list_robots(const World& world) {
    const hal::mock::Snapshot all = world.snapshot();
    shown_.robots.clear();
    for (std::size_t i = 0; i < all.robots.size(); ++i) {
      const Side side = world.side(i);
      const auto id = static_cast<RobotId>(world.id(i));
      const Strategy& strategy = game_.strategy(side);
      const PlayDecision* const decision = decision_of(strategy, id);
      ShownRobot robot{side, world.id(i), all.robots[i], label_of(decision, strategy.role_of(id))};
      if (decision != nullptr && decision->target) {
        // Strategies play towards positive x.
        const bool turned = (side == Side::kOpponent) != game_.game().rules().sides_exchanged();
        robot.target = (turned ? -1.0 : 1.0) * to_vector(*decision->target);
      }
      shown_.robots.push_back(std::move(robot));
    }
  }

  void follow_ball(const hal::mock::Game& game) {
    if (restarts_ != game.rules().restarts()) shown_.trail.clear();
    restarts_ = game.rules().restarts();
    shown_.ball = game.world().ball();
    if (shown_.trail.size() >= places_) shown_.trail.erase(shown_.trail.begin());
    shown_.trail.push_back(shown_.ball);
  }

  static std::size_t index_of(Restart restart) { return static_cast<std::size_t>(restart); }

  const TeamGame& game_;
  const std::size_t places_;  // of the ball's trail
  ShownGame shown_;
  GameStatistics before_;
  std::uint32_t restarts_ = 0;
  double event_until_s_ = 0.0;
};

}  // namespace

Result<GameResult> record_game(const hal::mock::ArenaParameters& arena, const Team& own, const Team& opponent,
                               const VideoSettings& settings, const std::function<void()>& progress) {
  TOUCHLINE_TRY_ASSIGN(const auto game, TeamGame::begin(arena, own, opponent, settings.seed, settings.view));
  replay::PictureOutput output;
  TOUCHLINE_TRY(output.open(settings.path, settings.rate_hz));
  Viewer viewer(*game, own, opponent, settings.rate_hz);
  const auto pictures = static_cast<std::uint64_t>(std::floor(settings.duration_s * settings.rate_hz));
  for (std::uint64_t i = 0; i <= pictures; ++i) {
    const double time_s = static_cast<double>(i) / settings.rate_hz;
    TOUCHLINE_TRY(game->advance_to(time_s));
    TOUCHLINE_TRY(output.write(*draw_game(arena, viewer.look()), i, "game", from_seconds(time_s)));
    if (progress) progress();
  }
  TOUCHLINE_TRY(game->advance_to(settings.duration_s));
  TOUCHLINE_TRY(output.finish());
  return GameResult{settings.seed, game->game().hash(), game->game().statistics()};
}

}  // namespace touchline::simulate
