#include "tools/programs/simulate/series_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "tools/programs/command_line/formatted.h"

namespace touchline::simulate {
namespace {

using nlohmann::json;

// Returns the 97.5 % quantile of Student's t distribution: Cornish and Fisher's expansion around the normal quantile
// (Abramowitz and Stegun 26.7.5). From 3 degrees of freedom on it is within 1 %; those below are exact.
double student_quantile(std::size_t freedom) {
  if (freedom == 1) return 12.706;
  if (freedom == 2) return 4.303;
  const double z = 1.959964, n = static_cast<double>(freedom), z2 = z * z;
  return z + z * (z2 + 1.0) / (4.0 * n) + z * (z2 * (5.0 * z2 + 16.0) + 3.0) / (96.0 * n * n) +
         z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / (384.0 * n * n * n);
}

template <class Value>
Mean mean_over(const Series& series, const Value& value) {
  std::vector<double> values;
  values.reserve(series.games.size());
  for (const GameResult& game : series.games) values.push_back(static_cast<double>(value(game)));
  return mean_of(values);
}

std::string text_of(const Mean& mean, int decimals) {
  if (!std::isfinite(mean.half_width)) return formatted("%.*f", decimals, mean.value);
  return formatted("%.*f +- %.*f", decimals, mean.value, decimals, mean.half_width);
}

double share_of_possession(const GameResult& game, std::size_t side) {
  const auto& held = game.statistics.possession_s;
  const double sum = held[0] + held[1];
  return sum > 0.0 ? held[side] / sum : 0.5;
}

// The own side's name, and how it sees.
std::string name_of_own(const Series& series) {
  return series.own + (series.view == OwnView::kPictures ? " (with pictures)" : "");
}

std::size_t index_of(Restart restart) { return static_cast<std::size_t>(restart); }

// Free balls are counted by all rules.
constexpr std::array<std::pair<const char*, Restart>, 3> kCountedRestarts{
    {{"penalties per minute", Restart::kPenalty},
     {"goal kicks per minute", Restart::kGoalKick},
     {"kick-offs per minute", Restart::kKickOff}}};

int count(const Series& series, bool (*is)(int difference)) {
  return static_cast<int>(std::count_if(series.games.begin(), series.games.end(),
                                        [is](const GameResult& game) { return is(game.difference()); }));
}

}  // namespace

Mean mean_of(std::span<const double> values) {
  Mean mean;
  for (const double value : values) mean.value += value / static_cast<double>(values.size());
  if (values.size() < 2) {
    mean.half_width = std::numeric_limits<double>::infinity();
    return mean;
  }
  double squares = 0.0;
  for (const double value : values) squares += (value - mean.value) * (value - mean.value);
  const auto count = static_cast<double>(values.size());
  mean.half_width = student_quantile(values.size() - 1) * std::sqrt(squares / (count - 1.0) / count);
  return mean;
}

std::string series_text(const Series& series) {
  const double minutes = series.duration_s / 60.0;
  const auto per_minute = [&](auto value) {
    return mean_over(series, [&](const GameResult& game) { return static_cast<double>(value(game)) / minutes; });
  };
  const auto row = [](const char* name, const std::string& own, const std::string& other) {
    return formatted("  %-26s %20s %20s\n", name, own.c_str(), other.c_str());
  };
  std::string out = formatted("%s against %s: %zu games of %.0f s\n", name_of_own(series).c_str(),
                              series.opponent.c_str(), series.games.size(), series.duration_s);
  out += row("", series.own, series.opponent);
  out += row("goals per game", text_of(mean_over(series, [](const auto& game) { return game.goals_own(); }), 2),
             text_of(mean_over(series, [](const auto& game) { return game.goals_opponent(); }), 2));
  out += row("games won", std::to_string(count(series, [](int difference) { return difference > 0; })),
             std::to_string(count(series, [](int difference) { return difference < 0; })));
  out += row("possession, %",
             text_of(mean_over(series, [](const auto& game) { return 100.0 * share_of_possession(game, 0); }), 1),
             text_of(mean_over(series, [](const auto& game) { return 100.0 * share_of_possession(game, 1); }), 1));
  out += row("touches per minute", text_of(per_minute([](const auto& game) { return game.statistics.touches[0]; }), 1),
             text_of(per_minute([](const auto& game) { return game.statistics.touches[1]; }), 1));
  out += row("contacts of own robots/min",
             text_of(per_minute([](const auto& game) { return game.statistics.contacts[0]; }), 1),
             text_of(per_minute([](const auto& game) { return game.statistics.contacts[1]; }), 1));
  out += row("fouls per minute", text_of(per_minute([](const auto& game) { return game.statistics.fouls[0]; }), 2),
             text_of(per_minute([](const auto& game) { return game.statistics.fouls[1]; }), 2));
  const auto both = [](const char* name, const Mean& mean) {
    return formatted("  %-26s %20s\n", name, text_of(mean, 2).c_str());
  };
  out += both("goal difference", mean_over(series, [](const auto& game) { return game.difference(); }));
  out += both("ball stood (over 3 s), %", mean_over(series, [&](const auto& game) {
                return 100.0 * game.statistics.ball_stood_s / series.duration_s;
              }));
  out += both("free balls per minute", per_minute([](const auto& game) { return game.statistics.free_balls; }));
  for (const auto& [name, restart] : kCountedRestarts) {
    out += both(name,
                per_minute([index = index_of(restart)](const auto& game) { return game.statistics.restarts[index]; }));
  }
  out += both("contacts with others/min", per_minute([](const auto& game) { return game.statistics.mixed_contacts; }));
  if (series.wall_s > 0.0) {
    out += formatted("  %.1f s: %.0f times real time\n", series.wall_s,
                     series.duration_s * static_cast<double>(series.games.size()) / series.wall_s);
  }
  return out;
}

std::string table_text(const std::vector<std::string>& names, const std::vector<Series>& games) {
  std::string out = formatted("%-16s", "goal difference");
  for (const std::string& name : names) out += formatted(" %16s", name.c_str());
  out += "\n";
  for (const std::string& own : names) {
    out += formatted("%-16s", own.c_str());
    for (const std::string& opponent : names) {
      const auto found = std::find_if(games.begin(), games.end(), [&](const Series& series) {
        return series.own == own && series.opponent == opponent;
      });
      const std::string cell =
          found == games.end() ? "" : text_of(mean_over(*found, [](const auto& game) { return game.difference(); }), 1);
      out += formatted(" %16s", cell.c_str());
    }
    out += "\n";
  }
  return out;
}

Result<Comparison> compare(const Series& a, const Series& b) {
  if (a.duration_s != b.duration_s) {
    return failure(ErrorCode::kInconsistent, "the games lasted %.0f s and %.0f s; compare equally long ones",
                   a.duration_s, b.duration_s);
  }
  std::map<std::uint64_t, const GameResult*> first;
  for (const GameResult& game : a.games) first[game.seed] = &game;
  std::vector<double> difference, own, opponent, possession;
  for (const GameResult& game : b.games) {
    const auto found = first.find(game.seed);
    if (found == first.end()) continue;
    const GameResult& before = *found->second;
    difference.push_back(static_cast<double>(game.difference() - before.difference()));
    own.push_back(static_cast<double>(game.goals_own() - before.goals_own()));
    opponent.push_back(static_cast<double>(game.goals_opponent() - before.goals_opponent()));
    possession.push_back(100.0 * (share_of_possession(game, 0) - share_of_possession(before, 0)));
  }
  if (difference.empty()) return Error{ErrorCode::kInconsistent, "the two series have no seed in common"};
  return Comparison{difference.size(), mean_of(difference), mean_of(own), mean_of(opponent), mean_of(possession)};
}

std::string comparison_text(const Series& a, const Series& b, const Comparison& comparison) {
  const Mean& mean = comparison.difference;
  const char* verdict = "the games do not show which one is better; play more seeds";
  if (mean.value - mean.half_width > 0.0) verdict = "the second one is better";
  if (mean.value + mean.half_width < 0.0) verdict = "the first one is better";
  return formatted("%s, then %s, against %s: %zu seeds, goal difference changes by %s (95 %%): %s\n",
                   name_of_own(a).c_str(), name_of_own(b).c_str(), b.opponent.c_str(), comparison.pairs,
                   text_of(mean, 2).c_str(), verdict) +
         formatted("  goals change by %s, the opponents' goals by %s, possession by %s %%\n",
                   text_of(comparison.goals_own, 2).c_str(), text_of(comparison.goals_opponent, 2).c_str(),
                   text_of(comparison.possession, 1).c_str());
}

std::string to_json(const std::vector<Series>& all) {
  json series = json::array();
  for (const Series& one : all) {
    json games = json::array();
    for (const GameResult& game : one.games) {
      const hal::mock::GameStatistics& s = game.statistics;
      games.push_back({{"seed", game.seed},
                       {"goals", {s.goals_own, s.goals_opponent}},
                       {"touches", s.touches},
                       {"possession_s", s.possession_s},
                       {"ball_stood_s", s.ball_stood_s},
                       {"ball_path_m", s.ball_path_m},
                       {"free_balls", s.free_balls},
                       {"contacts", s.contacts},
                       {"mixed_contacts", s.mixed_contacts},
                       {"fouls", s.fouls},
                       {"penalties", s.restarts[index_of(Restart::kPenalty)]},
                       {"goal_kicks", s.restarts[index_of(Restart::kGoalKick)]},
                       {"kick_offs", s.restarts[index_of(Restart::kKickOff)]},
                       {"hash", formatted("%016llx", static_cast<unsigned long long>(game.hash))}});
    }
    series.push_back({{"own", one.own},
                      {"opponent", one.opponent},
                      {"duration_s", one.duration_s},
                      {"pictures", one.view == OwnView::kPictures},
                      {"games", games}});
  }
  return json{{"schema", "touchline-simulate/1"}, {"series", series}}.dump(1) + "\n";
}

Result<std::vector<Series>> from_json(const std::string& text) {
  try {
    const json document = json::parse(text);
    if (document.at("schema") != "touchline-simulate/1") {
      return Error{ErrorCode::kInconsistent, "member \"schema\" is not \"touchline-simulate/1\""};
    }
    std::vector<Series> all;
    for (const json& one : document.at("series")) {
      Series series;
      series.own = one.at("own");
      series.opponent = one.at("opponent");
      series.duration_s = one.at("duration_s");
      // Results of older versions do not say it.
      if (one.value("pictures", false)) series.view = OwnView::kPictures;
      for (const json& game : one.at("games")) {
        GameResult result;
        result.seed = game.at("seed");
        result.hash = std::stoull(game.at("hash").get<std::string>(), nullptr, 16);
        hal::mock::GameStatistics& s = result.statistics;
        s.goals_own = game.at("goals").at(0);
        s.goals_opponent = game.at("goals").at(1);
        s.touches = game.at("touches");
        s.possession_s = game.at("possession_s");
        s.ball_stood_s = game.at("ball_stood_s");
        s.ball_path_m = game.at("ball_path_m");
        s.free_balls = game.at("free_balls");
        s.contacts = game.at("contacts");
        s.mixed_contacts = game.at("mixed_contacts");
        if (game.contains("fouls")) {  // results of older versions have none
          s.fouls = game.at("fouls");
          s.restarts[index_of(Restart::kPenalty)] = game.at("penalties");
          s.restarts[index_of(Restart::kGoalKick)] = game.at("goal_kicks");
          s.restarts[index_of(Restart::kKickOff)] = game.at("kick_offs");
        }
        series.games.push_back(result);
      }
      all.push_back(std::move(series));
    }
    return all;
  } catch (const std::exception& error) {
    return failure(ErrorCode::kInconsistent, "not a result of touchline-simulate: %s", error.what());
  }
}

}  // namespace touchline::simulate
