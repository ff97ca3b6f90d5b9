#include "tools/programs/simulate/lockstep_game.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <utility>

#include "firmware/arena_sides.h"
#include "firmware/network/json_line.h"
#include "hal/mock/turned_placement.h"
#include "tools/programs/simulate/game_series.h"

namespace touchline::simulate {
namespace {

using hal::mock::ArenaFault;
using hal::mock::ArenaParameters;
using hal::mock::FaultKind;
using hal::mock::Game;
using hal::mock::GameStatistics;
using hal::mock::other_side;
using hal::mock::Side;
using report::JsonWriter;
using report::write_number;

constexpr std::array kBothSides{Side::kOwn, Side::kOpponent};
// The fullest frame of the network, and as much again for truth and events.
constexpr std::size_t kMaxFrameBytes = 2 * network::kMaxDatagramBytes;
// Configurations that are kept. Randomized settings give a new one for each game.
constexpr std::size_t kMaxTeams = 16;

bool is_program(const std::string& name) { return name == kExternal || name == kOtherProgram; }

bool stalls_camera(FaultKind kind) { return kind == FaultKind::kCameraStall || kind == FaultKind::kCameraLost; }
bool stalls_radio(FaultKind kind) { return kind == FaultKind::kRadioLost || kind == FaultKind::kRadioBusy; }

Result<void> check_fault(const ArenaFault& fault, const ArenaParameters& arena) {
  if (!stalls_camera(fault.kind) && !stalls_radio(fault.kind) && fault.kind != FaultKind::kHideRobot) {
    return failure(ErrorCode::kUnsupported,
                   "fault.kind: a game without pictures has camera_stall, camera_lost, hide_robot, radio_lost and "
                   "radio_busy");
  }
  return check_robot(fault, arena);
}

// A step waits for its frames, and the server answers nothing meanwhile: a minute takes it less than a second.
constexpr double kMaxStall_s = 60.0;

// Refuses faults by which our camera would be silent for too long from `now_s` on.
Result<void> check_stalls(const std::vector<ArenaFault>& faults, double now_s) {
  double stall_s = 0.0;
  for (const ArenaFault& fault : faults) {
    if (stalls_camera(fault.kind)) stall_s += std::max(0.0, fault.at_s + fault.for_s - std::max(now_s, fault.at_s));
  }
  if (stall_s <= kMaxStall_s) return {};
  return failure(ErrorCode::kOutOfRange,
                 "fault.for_s: the camera would stall for %g s in all; at most %g s, because steps wait for its frames",
                 stall_s, kMaxStall_s);
}

report::TraceNames names_of(const config::Configuration& configuration, Side side) {
  report::TraceNames names{{"background"}, {}};
  for (const auto& color : configuration.venue.color) names.colors.push_back(color.name);
  const std::array<std::string, 2> teams = team_colors(configuration);
  const auto own = static_cast<std::size_t>(side);
  names.teams = {teams[own], teams[1 - own]};
  return names;
}

void write_event(JsonWriter& json, const char* kind, const std::string& team) {
  json.begin_object();
  json.key("kind");
  json.string(kind);
  json.key("team");
  if (team.empty()) {
    json.null();
  } else {
    json.string(team);
  }
  json.end_object();
}

std::string in_object(const char* key, const std::string& value) {
  return std::string("{\"") + key + "\":" + value + "}";
}

}  // namespace

LockstepGame::LockstepGame(std::string board, std::vector<std::string> overrides)
    : board_(std::move(board)), overrides_(std::move(overrides)), line_(kMaxFrameBytes) {}

Result<std::shared_ptr<const Team>> LockstepGame::team(const std::string& name,
                                                       const std::vector<std::string>& settings) {
  std::vector<std::string> overrides = overrides_;
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  // Robots without a command stand, and places are reached by the own control law.
  if (is_program(name)) overrides.emplace_back("control.play.enabled=false");
  std::string key = name;
  for (const std::string& each : overrides) key += "\n" + each;
  if (const auto found = teams_.find(key); found != teams_.end()) return found->second;
  TOUCHLINE_TRY_ASSIGN(Team loaded, load_team(board_, is_program(name) ? "play" : name, overrides));
  auto kept = std::make_shared<const Team>(std::move(loaded));
  if (teams_.size() >= kMaxTeams) teams_.clear();
  teams_.emplace(std::move(key), kept);
  return std::shared_ptr<const Team>(kept);
}

Result<ArenaParameters> LockstepGame::arena_of(const Team& own, const ResetMessage& message) const {
  ArenaParameters arena = fair_arena(*own.configuration, message.robots);
  arena.robots_return = message.robots_return;
  // Those of the board file's devices, which this game does not use; they may name robots that do not play.
  arena.fault.clear();
  for (const ArenaFault& fault : message.faults) TOUCHLINE_TRY(check_fault(fault, arena));
  TOUCHLINE_TRY(check_stalls(message.faults, 0.0));
  if (const auto violation = find_violation(arena)) {
    return failure(ErrorCode::kInconsistent, "arena.%s: %s", violation->key.c_str(), violation->message.c_str());
  }
  if (message.places.robots.empty() && !message.places.ball) return arena;
  // The places are checked in a game of their own, so that the game begins there, and robots return there.
  Game places(arena, own.configuration->board.radio, message.seed);
  // A ball that nobody places is put where no robot is, when the game begins.
  places.world().place_ball({arena.field.length_m, arena.field.width_m, 0.0});
  TOUCHLINE_TRY(put_objects(message.places, team_colors(*own.configuration), arena, places));
  const hal::mock::Snapshot all = places.world().snapshot();
  for (std::size_t i = 0; i < all.robots.size(); ++i) {
    arena.robot[i].x_m = all.robots[i].x_m;
    arena.robot[i].y_m = all.robots[i].y_m;
    arena.robot[i].theta_rad = all.robots[i].theta_rad;
  }
  return arena;
}

Result<void> LockstepGame::reset(const ResetMessage& message) {
  if (message.own == kOtherProgram) {
    return failure(ErrorCode::kInconsistent, "reset.own = \"program\": only the opponents can have another program");
  }
  TOUCHLINE_TRY_ASSIGN(const auto own, team(message.own, message.settings));
  TOUCHLINE_TRY_ASSIGN(const auto opponent, team(message.opponent, message.settings));
  TOUCHLINE_TRY_ASSIGN(ArenaParameters arena, arena_of(*own, message));
  std::array<SidePlayer, 2> players;
  for (const Side side : kBothSides) {
    SidePlayer& made = players[static_cast<std::size_t>(side)];
    const std::string& name = side == Side::kOwn ? message.own : message.opponent;
    const Team& of = side == Side::kOwn ? *own : *opponent;
    TOUCHLINE_TRY_ASSIGN(made.player, make_player(of, arena, side, message.seed));
    made.game = this;
    made.side = side;
    made.is_external = is_program(name);
    made.names = names_of(*own->configuration, side);
  }
  auto game = std::make_unique<Game>(arena, own->configuration->board.radio, message.seed);
  game->channel(Side::kOwn).set_layouts(own->configuration->pipeline.radio, own->configuration->pipeline.telemetry);
  const std::array<std::string, 2> colors = team_colors(*own->configuration);
  if (message.places.ball) TOUCHLINE_TRY(put_objects({{}, message.places.ball}, colors, arena, *game));
  colors_ = colors;
  arena_ = std::move(arena);
  game_ = std::move(game);
  players_ = std::move(players);
  field_ = own->configuration->pipeline.marker.field;
  rate_hz_ = own->configuration->board.camera.rate_hz;
  faults_ = message.faults;
  has_other_program_ = message.opponent == kOtherProgram;
  for (SidePlayer& each : players_) {
    game_->set_side(each.side, each.player.side.get());
    each.told = game_->statistics();
    each.restarts_told = game_->rules().restarts();
    each.player.side->set_observer(
        [](void* context, const StepTrace& trace) {
          auto& stepped = *static_cast<SidePlayer*>(context);
          stepped.game->on_step(stepped, trace);
        },
        &each);
  }
  return {};
}

std::string LockstepGame::description() const {
  std::string out(kMaxFrameBytes, '\0');
  JsonWriter json(out);
  json.begin_object();
  json.key("reset");
  json.begin_object();
  json.key("robots");
  json.begin_object();
  for (const Side side : kBothSides) {
    json.key(colors_[static_cast<std::size_t>(side)]);
    json.begin_array();
    for (std::size_t i = 0; i < game_->world().robots(); ++i) {
      if (game_->world().side(i) == side) json.integer(game_->world().id(i));
    }
    json.end_array();
  }
  json.end_object();
  json.key("own");
  json.string(colors_[0]);
  json.key("opponent");
  json.string(colors_[1]);
  json.key("rate_hz");
  json.number(rate_hz_);
  network::write_field(json, field_);
  json.key("robot_side");
  json.number(arena_.robot_side_m);
  json.key("ball_radius");
  json.number(arena_.ball_radius_m);
  json.end_object();
  json.end_object();
  out.resize(json.size());
  return out;
}

double LockstepGame::time_s() const { return game_ ? seconds(game_->now() - game_->begin()) : 0.0; }

Result<void> LockstepGame::check_commands(const ExternalCommands& commands, Side side, const char* list) const {
  const hal::mock::World& world = game_->world();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    std::size_t robot = 0;
    while (robot < world.robots() && (world.side(robot) != side || world.id(robot) != commands[i].id)) ++robot;
    if (robot == world.robots()) {
      return failure(ErrorCode::kNotFound, "step.%s[%zu].id = %d: team %s has no such robot", list, i,
                     int{commands[i].id}, colors_[static_cast<std::size_t>(side)].c_str());
    }
  }
  return {};
}

void LockstepGame::take_commands(const ExternalCommands& commands, Side side) {
  ExternalCommands& table = player(side).player.side->inputs().commands;
  for (ExternalCommand command : commands) {
    command.received = game_->now();
    auto* const known = std::find_if(table.begin(), table.end(),
                                     [&](const ExternalCommand& former) { return former.id == command.id; });
    // A side has at most as many robots as the table has places, and ids that it does not have are refused.
    if (known != table.end()) {
      *known = command;
    } else {
      table.push_back(command);
    }
  }
}

Result<void> LockstepGame::begin_step(Side side, const StepMessage& message) {
  if (has_other_program_ && message.opponent_commands.size() > 0) {
    return failure(ErrorCode::kInconsistent, "step.opponent_commands: another program drives the opponents");
  }
  TOUCHLINE_TRY(check_commands(message.commands, side, "commands"));
  TOUCHLINE_TRY(check_commands(message.opponent_commands, other_side(side), "opponent_commands"));
  take_commands(message.commands, side);
  take_commands(message.opponent_commands, other_side(side));
  for (SidePlayer& each : players_) {
    const bool is_own = each.side == side;
    if (!is_own && (has_other_program_ || !each.is_external)) continue;
    each.wanted = message;
    each.frames.clear();
    if (is_own) each.left = message.frames;
  }
  return {};
}

void LockstepGame::apply_faults() {
  const double now_s = time_s();
  bool camera = false, radio = false;
  for (const ArenaFault& fault : faults_) {
    if (!fault.is_active(now_s)) continue;
    camera = camera || stalls_camera(fault.kind);
    radio = radio || stalls_radio(fault.kind);
  }
  // As in `touchline run`, the faults are those of the own side's devices.
  player(Side::kOwn).player.side->set_faults(camera, radio);
  player(Side::kOwn).player.side->set_hidden_robots(hidden_robots(faults_, arena_, now_s));
}

void LockstepGame::run() {
  const auto is_waiting = [this] { return is_done(Side::kOwn) || (has_other_program_ && is_done(Side::kOpponent)); };
  while (!is_waiting()) {
    if (!faults_.empty()) apply_faults();
    game_->step();
  }
}

void LockstepGame::on_step(SidePlayer& player, const StepTrace& trace) {
  const bool counts = player.left > 0;
  if (counts) --player.left;
  const bool is_told = player.is_external || player.side == Side::kOwn;
  // The frames of an opponent that the own side's program drives, too, belong to the own side's step.
  const int left = has_other_program_ ? player.left : this->player(Side::kOwn).left;
  if (!is_told || (player.wanted.only_last && left > 0)) return;
  if (player.wanted.only_last) player.frames.clear();
  write_frame(player, trace);
}

void LockstepGame::write_frame(SidePlayer& player, const StepTrace& trace) {
  const StepInputs& inputs = player.player.side->inputs();
  copy_trace(trace, snapshot_);
  snapshot_.number = player.player.side->frames() - 1;
  snapshot_.sent = game_->now();
  snapshot_.halt = inputs.halt != 0 ? kHaltReferee : kHaltNone;
  const GameSituation situation = game_->rules().situation(player.side);
  snapshot_.referee = {};
  snapshot_.referee.phase = inputs.halt != 0 ? GamePhase::kPrepare : GamePhase::kRunning;
  if (situation.phase != GamePhase::kNoReferee) snapshot_.referee.phase = situation.phase;
  snapshot_.referee.restart = situation.restart;
  snapshot_.referee.restart_is_ours = situation.ours;
  snapshot_.referee.lines_up = situation.lines_up;
  snapshot_.referee.own_on_positive_half = game_->rules().sides_exchanged();
  snapshot_.referee.received = game_->now();
  const GameStatistics& statistics = game_->statistics();
  const bool is_own = player.side == Side::kOwn;
  snapshot_.referee.score = is_own ? Score{statistics.goals_own, statistics.goals_opponent}
                                   : Score{statistics.goals_opponent, statistics.goals_own};
  JsonWriter json(line_);
  json.begin_object();
  json.key("schema");
  json.integer(network::kJsonSchema);
  if (player.wanted.sightings) {
    report::write_frame(json,
                        {snapshot_.captured, snapshot_.ball, snapshot_.robots, snapshot_.tracks, snapshot_.overload},
                        player.names, snapshot_.number, "");
  } else {
    json.key("frame");
    json.integer(static_cast<std::int64_t>(snapshot_.number));
    write_number(json, "t", seconds(snapshot_.captured.time_since_epoch()), report::kSecondStep);
    json.key("tracks");
    report::write_tracks(json, snapshot_.tracks, player.names);
  }
  network::write_game_members(json, snapshot_, player.names, field_);
  if (player.wanted.truth) write_truth(json, player);
  write_events(json, player);
  json.end_object();
  if (!player.frames.empty()) player.frames += ',';
  player.frames.append(line_.data(), json.size());
}

void LockstepGame::write_truth(JsonWriter& json, const SidePlayer& player) const {
  const hal::mock::World& world = game_->world();
  const hal::mock::Snapshot all = world.snapshot();
  const bool is_own = player.side == Side::kOwn;
  const double sign = is_own ? 1.0 : -1.0;
  const auto write_place = [&](const hal::mock::Placement& at) {
    write_number(json, "x", at.x_m, report::kMeterStep);
    write_number(json, "y", at.y_m, report::kMeterStep);
  };
  json.key("truth");
  json.begin_object();
  json.key("t");
  json.number(report::rounded(seconds(game_->now().time_since_epoch()), report::kSecondStep));
  json.key("ball");
  json.begin_object();
  write_place(is_own ? all.ball : turned(all.ball));
  write_number(json, "vx", sign * world.ball_velocity().x, report::kSpeedStep);
  write_number(json, "vy", sign * world.ball_velocity().y, report::kSpeedStep);
  json.end_object();
  json.key("robots");
  json.begin_object();
  for (const Side side : kBothSides) {
    json.key(colors_[static_cast<std::size_t>(side)]);
    json.begin_object();
    for (std::size_t i = 0; i < all.robots.size(); ++i) {
      if (world.side(i) != side) continue;
      json.key(std::to_string(world.id(i)));
      json.begin_object();
      const hal::mock::Placement at = is_own ? all.robots[i] : turned(all.robots[i]);
      write_place(at);
      write_number(json, "theta", at.theta_rad, report::kRadianStep);
      json.end_object();
    }
    json.end_object();
  }
  json.end_object();
  json.end_object();
}

void LockstepGame::write_events(JsonWriter& json, SidePlayer& player) const {
  const GameStatistics& now = game_->statistics();
  const GameStatistics before = std::exchange(player.told, now);
  const std::uint32_t restarts = game_->rules().restarts(),
                      restarts_before = std::exchange(player.restarts_told, restarts);
  json.key("events");
  json.begin_array();
  for (std::size_t i = 0; i < colors_.size(); ++i) {
    const std::uint32_t goals = i == 0 ? now.goals_own : now.goals_opponent;
    const std::uint32_t former = i == 0 ? before.goals_own : before.goals_opponent;
    if (goals != former) write_event(json, "goal", colors_[i]);
    if (now.touches[i] != before.touches[i]) write_event(json, "touch", colors_[i]);
    if (now.contacts[i] != before.contacts[i]) write_event(json, "contact", colors_[i]);
  }
  if (now.mixed_contacts != before.mixed_contacts) write_event(json, "contact", "");
  if (now.free_balls != before.free_balls) write_event(json, "free_ball", "");
  if (restarts != restarts_before) write_event(json, "restart", "");
  json.end_array();
}

std::string LockstepGame::end_step(Side side) {
  std::string out = "{\"frames\":[" + std::exchange(player(side).frames, {}) + "]";
  if (!has_other_program_ && player(other_side(side)).is_external) {
    out += ",\"opponent_frames\":[" + std::exchange(player(other_side(side)).frames, {}) + "]";
  }
  return out + "}";
}

Result<std::string> LockstepGame::place(const PlaceMessage& message) {
  TOUCHLINE_TRY(put_objects(message.places, colors_, arena_, *game_));
  return in_object("done", "\"place\"");
}

Result<std::string> LockstepGame::inject(const FaultMessage& message) {
  TOUCHLINE_TRY(check_fault(message.fault, arena_));
  const double now_s = time_s();
  // Faults that are over leave the list, so that it does not grow.
  std::erase_if(faults_, [now_s](const ArenaFault& fault) { return now_s >= fault.at_s + fault.for_s; });
  std::vector<ArenaFault> faults = faults_;
  faults.push_back(message.fault);
  faults.back().at_s += now_s;
  TOUCHLINE_TRY(check_stalls(faults, now_s));
  faults_ = std::move(faults);
  return in_object("done", "\"fault\"");
}

std::string LockstepGame::hash() const {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "\"%016" PRIx64 "\"", game_->hash());
  return in_object("hash", text.data());
}

}  // namespace touchline::simulate
