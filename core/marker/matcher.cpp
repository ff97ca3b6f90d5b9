#include "core/marker/matcher.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/marker/centroid_noise.h"
#include "core/parameter.h"

namespace touchline {
namespace {

// Minimum area ratio of a team patch without identification patches that is reported as a robot.
constexpr float kMinUnpairedRatio = 0.5f;
// For each team, the number of team patches that are examined beyond the number of its robots.
constexpr std::size_t kSurplusPlaces = 2;
// Factor on the work for splitting all patches of both teams into pairs. Regions of three or four patches take more
// than two pairs: ten robots without a gap between them need a factor of 2.5, with 12 colors in the picture.
constexpr float kMarginOfPairs = 3.0f;
// Least number of pairs for a color: enough for one region of four patches, the largest that is split.
constexpr float kMinPairsOfColor = 4.0f;

// Confidence of robots from boxes alone. If the pixels of the frame are available, this value is replaced: by
// identifier_ for robots with an id, by likely_robot() for robots without.
constexpr float kFound = 0.99f;

constexpr std::array<Team, 2> kTeams{Team::kOwn, Team::kOpponent};

// Returns whether a team patch is too small for a robot, unless it has an identification patch or pixels give it an id.
bool is_too_small(const PatchCandidate& patch) { return patch.is_partly_visible || patch.ratio < kMinUnpairedRatio; }

}  // namespace

void Matcher::add_kind(ColorId color, const PatchPlace& place, Team team) {
  const MarkerLayout& layout = parameters_.teams[index_of(team)].layout;
  PatchKind& kind = kinds_[color];
  if (!wanted_[color]) {
    kind = kind_of(place, layout.height_m);
    kind.plane = index_of(team);
    wanted_[color] = true;
  } else {
    widen(kind, place);
  }
  kind.height_m[index_of(team)] = layout.height_m;
}

Status Matcher::check(const TeamMarkings& teams, const BallParameters& ball) {
  std::array<bool, kMaxColors + 1> of_team{}, identifies{};
  for (const TeamMarking& marking : teams) {
    if (Status s = validate(marking); !s.ok()) return s;
    if (marking.team_color == kBackground) continue;
    of_team[marking.team_color] = true;
    for (const RobotMarking& robot : marking.robots) {
      for (const ColorId color : robot.colors) identifies[color] = true;
    }
  }
  if (ball.color > kMaxColors || (ball.color != kBackground && !is_positive(ball.radius_m))) {
    return ErrorCode::kOutOfRange;
  }
  const ColorId own = teams[0].team_color, other = teams[1].team_color;
  if ((own != kBackground && own == other) || identifies[own] || identifies[other] ||
      (ball.color != kBackground && (of_team[ball.color] || identifies[ball.color]))) {
    return ErrorCode::kInconsistent;
  }
  return {};
}

void Matcher::collect_kinds() {
  wanted_.fill(false);
  identifies_.fill(false);
  std::size_t patches = 0;
  for (const Team team : kTeams) {
    const TeamMarking& marking = parameters_.teams[index_of(team)];
    if (marking.team_color == kBackground) continue;
    patches += std::size_t{marking.max_robots} * marking.layout.patches.size();
    add_kind(marking.team_color, marking.layout.patches[0], team);
    kinds_[marking.team_color].may_be_partly_hidden = true;
    for (const RobotMarking& robot : marking.robots) {
      for (std::size_t s = 0; s < robot.colors.size(); ++s) {
        add_kind(robot.colors[s], marking.layout.patches[s + 1], team);
        kinds_[robot.colors[s]].may_be_partly_hidden = true;
        identifies_[robot.colors[s]] = true;
      }
    }
  }
  const auto colors = static_cast<float>(std::count(wanted_.begin(), wanted_.end(), true));
  touching_pairs_ = std::min(kMaxTouchingPairs,
                             std::max(kMinPairsOfColor * colors, kMarginOfPairs * static_cast<float>(patches) / 2));
  const BallParameters& ball = parameters_.ball;
  if (ball.color != kBackground) {
    kinds_[ball.color] = kind_of(outline_of(ball), ball.radius_m);
    kinds_[ball.color].may_touch = false;  // a ball touches no other ball, because there is only one
    kinds_[ball.color].may_be_partly_hidden = true;
    wanted_[ball.color] = true;
  }
}

Status Matcher::configure(const MarkerParameters& parameters, const CameraModel& camera) {
  wanted_.fill(false);
  if (!is_positive(parameters.field.length_m) || !is_positive(parameters.field.width_m)) return ErrorCode::kOutOfRange;
  if (Status s = check(parameters.teams, parameters.ball); !s.ok()) return s;
  parameters_ = parameters;
  collect_kinds();
  finder_.configure(camera, parameters.field);
  identifier_.configure(camera);
  ball_finder_.configure(parameters.ball);
  identifier_.set_teams(parameters.teams);
  return {};
}

Status Matcher::set_teams(const TeamMarkings& teams) {
  if (Status s = check_teams(teams); !s.ok()) return s;
  parameters_.teams = teams;
  collect_kinds();
  identifier_.set_teams(teams);
  return {};
}

// Lists the largest regions of each color by area; among equal ones the first in the picture comes first (radix sort,
// byte by byte).
void Matcher::sort_by_color(const Regions& regions, Sightings& out) {
  std::array<std::uint16_t, kMaxRegions> by_area, sorted;
  std::size_t count = 0;
  std::uint32_t all_areas = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].color > kMaxColors || !wanted_[regions[i].color]) continue;
    by_area[count++] = static_cast<std::uint16_t>(i);
    all_areas |= regions[i].area_px;
  }
  for (std::uint32_t shift = 0; shift < 32 && all_areas >> shift != 0; shift += 8) {
    // The digits are inverted, so that the largest regions come first.
    const auto digit = [&](std::uint16_t number) { return ~(regions[number].area_px >> shift) & 0xffu; };
    std::array<std::uint16_t, 257> begin{};
    for (std::size_t k = 0; k < count; ++k) ++begin[digit(by_area[k]) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (std::size_t k = 0; k < count; ++k) sorted[begin[digit(by_area[k])]++] = by_area[k];
    std::copy(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count), by_area.begin());
  }
  for (Numbers& numbers : numbers_) numbers.clear();
  for (std::size_t k = 0; k < count; ++k) {
    if (!numbers_[regions[by_area[k]].color].push_back(by_area[k])) out.verdicts[by_area[k]] = Verdict::kSurplus;
  }
}

void Matcher::add_team_patches(Team team, Sightings& out) {
  constexpr std::size_t kShare = kMaxTeamPatches / 2;
  for (std::size_t i = 0; i < of_color_.size(); ++i) {
    if (i < kShare) {
      team_patches_.push_back({of_color_[i], team});
    } else {
      out.verdicts[of_color_[i].region] = Verdict::kSurplus;
    }
  }
}

bool Matcher::find_patches(const Runs& runs, const Regions& regions, Sightings& out) {
  team_patches_.clear();
  identification_.clear();
  ball_patches_.clear();
  const auto is_present = [this](std::size_t color) { return wanted_[color] && !numbers_[color].empty(); };
  std::size_t colors = 0;
  for (std::size_t color = 1; color <= kMaxColors; ++color) {
    colors += static_cast<std::size_t>(is_present(color) && color != parameters_.ball.color);
  }
  WorkBudget<float> pairs(touching_pairs_, colors);
  bool complete = true;
  for (std::size_t color = 1; color <= kMaxColors; ++color) {
    if (!is_present(color)) continue;
    const std::span<const std::uint16_t> candidates(numbers_[color].data(), numbers_[color].size());
    if (color == parameters_.ball.color) {
      SplitBudget none;
      finder_.find(kinds_[color], runs, regions, candidates, out, none, ball_patches_);
      continue;
    }
    SplitBudget budget{pairs.take()};
    finder_.find(kinds_[color], runs, regions, candidates, out, budget, of_color_);
    pairs.give_back(budget.pairs);
    complete = complete && !budget.exceeded;
    if (identifies_[color]) {
      for (const PatchCandidate& patch : of_color_) {
        if (!identification_.push_back(patch)) out.verdicts[patch.region] = Verdict::kSurplus;
      }
    } else {
      add_team_patches(color == parameters_.teams[0].team_color ? Team::kOwn : Team::kOpponent, out);
    }
  }
  return complete;
}

std::size_t Matcher::free_places(Team team, const Sightings& out) const {
  const auto there = std::count_if(out.robots.begin(), out.robots.end(),
                                   [team](const RobotSighting& robot) { return robot.team == team; });
  const std::size_t most = parameters_.teams[index_of(team)].max_robots;
  return most > static_cast<std::size_t>(there) ? most - static_cast<std::size_t>(there) : 0;
}

void Matcher::report_pair(const Chosen& choice, Sightings& out) {
  const Hypothesis& h = hypotheses_[choice.hypothesis];
  const TeamMarking& marking = parameters_.teams[index_of(h.team)];
  const PatchCandidate& team_patch = team_patches_[h.team_patch].patch;
  RobotSighting robot;
  robot.team = h.team;
  robot.patches.push_back({PatchRole::kTeam, 0, team_patch.color, team_patch.center});
  for (std::size_t s = 0; s + 1 < marking.layout.patches.size(); ++s) {
    const std::uint16_t number = h.identification[s];
    if (number == kMissing) continue;
    used_[number] = true;
    const PatchCandidate& patch = identification_[number];
    const auto place = static_cast<std::uint8_t>(s + 1);
    robot.patches.push_back({PatchRole::kIdentification, place, patch.color, patch.center});
  }
  // For a team without known robots, hypotheses only reserve the patches, so that no other robot uses them.
  const bool known_team = !marking.robots.empty();
  const bool known_pose = known_team && choice.pose_is_sure;
  robot.has_heading = known_pose && h.has_heading;
  robot.residual_m = h.fit.residual_m;
  robot.pose = h.fit.pose;
  if (!known_pose) {
    robot.pose = {team_patch.at[index_of(h.team)], 0.0f};
    robot.residual_m = 0.0f;
  }
  robot.confidence = kFound;
  if (known_pose && choice.id_is_sure && h.precise) robot.id = marking.robots[static_cast<std::size_t>(h.robot)].id;
  if (known_team && robot.id == kUnknownId) {
    robot.doubt = !known_pose          ? IdDoubt::kSeveralPoses
                  : !choice.id_is_sure ? IdDoubt::kSeveralIds
                                       : IdDoubt::kInaccuratePlaces;
  }
  reported_[h.team_patch] = true;
  out.robots.push_back(robot);
  const bool complete = h.seen + 1u == marking.layout.patches.size();
  box_sightings_.push_back({h.team_patch, choice.hypothesis, known_pose && h.has_heading && h.precise && complete});
}

void Matcher::report_pairs(Sightings& out) {
  // Put the best ones first, in case there are more than the maximum number of robots.
  std::sort(selection_.begin(), selection_.end(), [this](const Chosen& a, const Chosen& b) {
    return hypotheses_[a.hypothesis].value > hypotheses_[b.hypothesis].value;
  });
  for (const Chosen& choice : selection_) {
    if (free_places(hypotheses_[choice.hypothesis].team, out) > 0) report_pair(choice, out);
  }
}

// Returns true if the team patch is on the top of an identified robot and so does not belong to another one.
bool Matcher::is_on_robot(const TeamPatch& patch, const Sightings& out) const {
  return std::any_of(out.robots.begin(), out.robots.end(), [&](const RobotSighting& robot) {
    if (!robot.has_heading) return false;
    const MarkerLayout& layout = parameters_.teams[index_of(robot.team)].layout;
    // Skip a robot whose corners are nearer than the patch.
    if (distance_m(robot.pose.position, patch.patch.at[index_of(robot.team)]) > layout.robot_side_m) return false;
    return on_robot(layout, to_robot_frame(robot.pose, patch.patch.at[index_of(robot.team)]), 0.0f);
  });
}

// Reports team patches without identification patches. Patches that are too small for a robot are tentative: they are
// kept only if their pixels give them a name.
void Matcher::report_unpaired(bool with_pixels, Sightings& out) {
  std::array<std::size_t, 2> surplus_places{kSurplusPlaces, kSurplusPlaces};
  // The list is sorted by area within a team, the largest first.
  for (std::size_t i = 0; i < team_patches_.size(); ++i) {
    if (reported_[i]) continue;
    const TeamPatch& candidate = team_patches_[i];
    Verdict& verdict = out.verdicts[candidate.patch.region];
    const bool too_small = is_too_small(candidate.patch), on_robot = is_on_robot(candidate, out);
    if (candidate.patch.is_partly_visible) {
      verdict = Verdict::kTooSmall;
    } else if (on_robot) {
      verdict = Verdict::kTooClose;
    } else if (too_small) {
      verdict = Verdict::kNoPartner;
    }
    if (on_robot || (too_small && !with_pixels)) continue;
    const bool is_surplus = free_places(candidate.team, out) == 0;
    if (is_surplus) {
      if (!too_small) verdict = Verdict::kSurplus;
      // A saturated identification patch in the box of the team color may have taken its place.
      std::size_t& places = surplus_places[index_of(candidate.team)];
      if (too_small || !with_pixels || places == 0) continue;
      --places;
    }
    RobotSighting robot;
    robot.team = candidate.team;
    robot.pose.position = candidate.patch.at[index_of(candidate.team)];
    robot.confidence = kFound;
    if (!parameters_.teams[index_of(candidate.team)].robots.empty()) robot.doubt = IdDoubt::kNoIdentification;
    robot.patches.push_back({PatchRole::kTeam, 0, candidate.patch.color, candidate.patch.center});
    reported_[i] = true;
    out.robots.push_back(robot);
    box_sightings_.push_back({static_cast<std::uint16_t>(i), kMissing, false, too_small || is_surplus});
  }
}

void Matcher::drop_tentative(Sightings& out) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    const BoxSighting& box = box_sightings_[i];
    const bool has_unknown_id = out.robots[i].id == kUnknownId;
    // A patch in the box of the team color may be the saturated identification patch of a robot that has its id now.
    const bool is_absorbed =
        !out.robots[i].has_heading && has_unknown_id && is_on_robot(team_patches_[box.team_patch], out);
    if ((box.is_tentative && has_unknown_id && is_too_small(team_patches_[box.team_patch].patch)) || is_absorbed) {
      reported_[box.team_patch] = false;
    } else {
      box_sightings_[kept] = box;
      out.robots[kept++] = out.robots[i];
    }
  }
  out.robots.resize(kept);
  box_sightings_.resize(kept);
}

// Removes robots if a team has more than possible: of robots without an id the least certain ones, among equal ones the
// smallest patches.
void Matcher::drop_surplus(Sightings& out) {
  for (const Team team : kTeams) {
    for (;;) {
      std::size_t there = 0, weakest = out.robots.size();
      for (std::size_t i = 0; i < out.robots.size(); ++i) {
        if (out.robots[i].team != team) continue;
        ++there;
        if (out.robots[i].id != kUnknownId) continue;
        if (weakest == out.robots.size() || out.robots[i].confidence <= out.robots[weakest].confidence) weakest = i;
      }
      if (there <= parameters_.teams[index_of(team)].max_robots || weakest == out.robots.size()) break;
      reported_[box_sightings_[weakest].team_patch] = false;
      std::copy(out.robots.begin() + weakest + 1, out.robots.end(), out.robots.begin() + weakest);
      std::copy(box_sightings_.begin() + weakest + 1, box_sightings_.end(), box_sightings_.begin() + weakest);
      out.robots.pop_back();
      box_sightings_.pop_back();
    }
  }
}

void Matcher::write_verdicts(Sightings& out) {
  std::array<bool, kMaxIdentification> is_in_hypothesis{};
  for (const Hypothesis& h : hypotheses_) {
    for (std::size_t s = 0; s + 1 < parameters_.teams[index_of(h.team)].layout.patches.size(); ++s) {
      if (h.identification[s] != kMissing) is_in_hypothesis[h.identification[s]] = true;
    }
  }
  // Used patches come second, so a region of several parts gets the verdict of the used part.
  for (const bool used : {false, true}) {
    for (std::size_t i = 0; i < identification_.size(); ++i) {
      if (used_[i] != used || (identification_[i].is_partly_visible && !used)) continue;
      out.verdicts[identification_[i].region] = used                  ? Verdict::kIdentification
                                                : is_in_hypothesis[i] ? Verdict::kPartnerTaken
                                                                      : Verdict::kNoPartner;
    }
  }
  for (std::size_t i = 0; i < team_patches_.size(); ++i) {
    if (reported_[i]) out.verdicts[team_patches_[i].patch.region] = Verdict::kTeamPatch;
  }
}

void Matcher::match(const Frame* frame, const ExpectedGain& light, const ExpectedBall& ball, const Runs& runs,
                    const Regions& regions, Sightings& out) {
  out.ball = {};
  out.robots.clear();
  out.verdicts.clear();
  out.verdicts.resize(regions.size());
  std::fill(out.verdicts.begin(), out.verdicts.end(), Verdict::kNotExamined);
  reported_.fill(false);
  used_.fill(false);
  box_sightings_.clear();

  sort_by_color(regions, out);
  bool complete = find_patches(runs, regions, out);
  hypotheses_.clear();
  const PatchLists lists{{team_patches_.data(), team_patches_.size()},
                         {identification_.data(), identification_.size()}};
  WorkBudget<int> work(kMaxNeighborTests, team_patches_.size());
  for (std::size_t i = 0; i < team_patches_.size(); ++i) {
    if (!add_hypotheses(parameters_.teams, lists, i, work, hypotheses_)) complete = false;
  }
  complete = complete && hypotheses_.overflow() == 0 && identification_.overflow() == 0;
  const std::array<float, 2> sides{parameters_.teams[0].layout.robot_side_m, parameters_.teams[1].layout.robot_side_m};
  complete =
      selector_.select({hypotheses_.data(), hypotheses_.size()}, team_patches_.size(), sides, selection_) && complete;
  report_pairs(out);
  report_unpaired(frame != nullptr, out);
  if (frame != nullptr) {
    identifier_.identify(*frame, light, lists, {hypotheses_.data(), hypotheses_.size()},
                         {box_sightings_.data(), box_sightings_.size()}, !complete, used_, out);
    drop_tentative(out);
    doubt_cut_patches(frame, regions, out);
    weigh_unknown_id(*frame, out);
    drop_surplus(out);
  } else {
    doubt_cut_patches(nullptr, regions, out);
  }
  write_verdicts(out);
  ball_finder_.find({frame, ball_patches_, finder_, parameters_.teams, regions, ball}, out);
  write_centroid_noise(finder_.camera(), parameters_.teams, parameters_.ball.radius_m, out);
  out.cut_short = !complete;
}

}  // namespace touchline
