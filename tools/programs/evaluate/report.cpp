#include "tools/programs/evaluate/report.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tools/programs/evaluate/report_text.h"

namespace touchline::evaluate {
namespace {

using nlohmann::ordered_json;

// Returns text such as "118 (98.3 %)"; without percentage if `whole` is 0.
std::string share(std::size_t part, std::size_t whole) {
  char text[64];
  if (whole == 0) {
    std::snprintf(text, sizeof text, "%zu", part);
  } else {
    std::snprintf(text, sizeof text, "%zu (%.2f %%)", part,
                  100.0 * static_cast<double>(part) / static_cast<double>(whole));
  }
  return text;
}

void print_errors(std::ostream& out, const char* name, const statistics::ErrorSummary& s,
                  const statistics::ErrorSummary& t, double factor, const char* unit) {
  const auto cell = [&](const statistics::ErrorSummary& e) {
    char text[96];
    std::snprintf(text, sizeof text, "%8.3f %8.3f %8.3f", e.rms * factor, e.p95 * factor, e.max * factor);
    return e.count == 0 ? std::string("       -        -        -") : std::string(text);
  };
  line(out, "%-26s %s   %s  %s", name, cell(s).c_str(), cell(t).c_str(), unit);
}

ordered_json json_of(const Reliability& reliability) {
  ordered_json bins = ordered_json::array();
  for (const Reliability::Bin& bin : reliability.bins()) {
    if (bin.count == 0) continue;
    bins.push_back({{"low", bin.low},
                    {"high", bin.high},
                    {"count", bin.count},
                    {"right", bin.right},
                    {"mean_confidence", bin.confidence_sum / static_cast<double>(bin.count)}});
  }
  return {{"count", reliability.count()}, {"calibration_error", reliability.calibration_error()}, {"bins", bins}};
}

ordered_json json_of(const ReliabilityOfScene& reliability) {
  return {{"calibration_error", reliability.all().calibration_error()},
          {"robots_with_id", json_of(reliability.named)},
          {"robots_without_id", json_of(reliability.unnamed)},
          {"ball", json_of(reliability.ball)}};
}

struct ReliabilitySource {
  const char* name;  // "sightings" or "tracks"
  const ReliabilityOfScene& reliability;
};

std::string right_aligned(const std::string& text) {
  constexpr std::size_t kWidth = 18;
  return std::string(kWidth - std::min(text.size(), kWidth), ' ') + text;
}

// Prints a row for each bin of confidence, with the share of its reports that are right.
void print_reliability(const std::vector<ReliabilitySource>& sources, std::ostream& out) {
  std::string title, errors;
  std::vector<const Reliability*> columns;
  for (const auto& [name, reliability] : sources) {
    const Reliability all = reliability.all();
    if (all.count() == 0) continue;  // the results have no confidences
    for (const char* kind : {"id", "no id", "ball"}) title += right_aligned(name + std::string(", ") + kind);
    columns.insert(columns.end(), {&reliability.named, &reliability.unnamed, &reliability.ball});
    char text[64];
    std::snprintf(text, sizeof text, "%s%s %.4f", errors.empty() ? "" : ", ", name, all.calibration_error());
    errors += text;
  }
  if (columns.empty()) return;
  out << "\nright, of all with this confidence\n" << right_aligned("") << title << '\n';
  for (std::size_t i = 0; i < columns.front()->bins().size(); ++i) {
    char text[64];
    std::snprintf(text, sizeof text, "%.2f to %.2f", columns.front()->bins()[i].low, columns.front()->bins()[i].high);
    std::string row = right_aligned(text);
    for (const Reliability* column : columns) {
      const Reliability::Bin& bin = column->bins()[i];
      row += right_aligned(bin.count == 0 ? "-" : share(bin.right, bin.count));
    }
    out << row << '\n';
  }
  out << "expected calibration error: " << errors << '\n';
}

ordered_json json_of(const PoseSummary& s) {
  return {{"robots", s.robots},
          {"right", s.right},
          {"unknown", s.unknown},
          {"swapped", s.swapped},
          {"missed", s.missed},
          {"ghosts", s.ghosts},
          {"balls", s.balls},
          {"balls_seen", s.balls_seen},
          {"balls_missed", s.balls_missed},
          {"ball_ghosts", s.ball_ghosts},
          {"position_m", json_of_errors(s.position)},
          {"angle_rad", json_of_errors(s.angle)},
          {"ball_m", json_of_errors(s.ball)},
          {"reliability", json_of(s.reliability)}};
}

ordered_json json_of(const std::vector<PoseSpread>& spreads) {
  ordered_json list = ordered_json::array();
  for (const PoseSpread& s : spreads) {
    list.push_back({{"name", s.name},
                    {"frames", s.frames},
                    {"position_rms_m", s.position_rms},
                    {"position_max_m", s.position_max},
                    {"angle_rms_rad", s.angle_rms},
                    {"angle_max_rad", s.angle_max},
                    {"largest_step_m", s.largest_step},
                    {"mean_m", {s.mean.x, s.mean.y}}});
  }
  return list;
}

}  // namespace

void print(const PoseReport& report, double seen_within_m, std::ostream& out) {
  const PoseSummary &s = report.sightings, &t = report.tracks;
  line(out, "%zu frames, %zu robots and %zu balls in the truth; matched within %.1f mm", report.frames, s.robots,
       s.balls, seen_within_m * kMillimeters);
  if (report.frames_without_result > 0)
    line(out, "%zu frames have no result; their robots and balls count as missed", report.frames_without_result);
  if (report.results_without_truth > 0)
    line(out, "%zu results have no truth and are ignored", report.results_without_truth);
  line(out, "\n%-26s %-26s   %s", "", "sightings", "tracks");
  const auto counts = [&](const char* name, std::size_t PoseSummary::*part, std::size_t PoseSummary::*whole) {
    const std::size_t all_s = whole == nullptr ? 0 : s.*whole, all_t = whole == nullptr ? 0 : t.*whole;
    line(out, "%-26s %-26s   %s", name, share(s.*part, all_s).c_str(), share(t.*part, all_t).c_str());
  };
  counts("robots, right id", &PoseSummary::right, &PoseSummary::robots);
  counts("robots, unknown id", &PoseSummary::unknown, &PoseSummary::robots);
  counts("robots, swapped id", &PoseSummary::swapped, &PoseSummary::robots);
  counts("robots missed", &PoseSummary::missed, &PoseSummary::robots);
  counts("robot ghosts", &PoseSummary::ghosts, nullptr);
  counts("ball seen", &PoseSummary::balls_seen, &PoseSummary::balls);
  counts("ball missed", &PoseSummary::balls_missed, &PoseSummary::balls);
  counts("ball ghosts", &PoseSummary::ball_ghosts, nullptr);
  line(out, "\n%-26s %8s %8s %8s   %8s %8s %8s", "error", "RMS", "p95", "max", "RMS", "p95", "max");
  print_errors(out, "robot position", s.position, t.position, kMillimeters, "mm");
  print_errors(out, "robot angle", s.angle, t.angle, kDegrees, "deg");
  print_errors(out, "ball position", s.ball, t.ball, kMillimeters, "mm");
  print_reliability({{"sightings", s.reliability}, {"tracks", t.reliability}}, out);
  if (!report.spread.empty()) {
    out << "\nNothing moves in the truth: deviations of the sightings from their mean\n";
    print(report.spread, report.frames, out);
  }
}

void print(const std::vector<PoseSpread>& spread, std::size_t frames, std::ostream& out) {
  line(out, "%-20s %-18s %17s %17s %9s   %s", "", "frames", "RMS mm      max", "RMS deg     max", "step mm",
       "mean x, y m");
  for (const PoseSpread& s : spread) {
    line(out, "%-20s %-18s %8.3f %8.3f %8.3f %8.3f %9.3f   %.4f, %.4f", s.name.c_str(), share(s.frames, frames).c_str(),
         s.position_rms * kMillimeters, s.position_max * kMillimeters, s.angle_rms * kDegrees, s.angle_max * kDegrees,
         s.largest_step * kMillimeters, s.mean.x, s.mean.y);
  }
}

void print(const std::vector<PictureReport>& pictures, const PictureTolerance& tolerance, std::ostream& out) {
  line(out, "ids: right/unknown/wrong; patch and ball errors in pixels (RMS, max); good: within %.1f px",
       tolerance.good_px);
  line(out, "%-22s %9s %9s %11s %13s %9s %11s %13s %7s %6s %7s", "picture", "robots", "team good", "RMS   max",
       "ident. good", "ids", "RMS   max", "ball good", "px", "ghosts", "unclear");
  const auto row = [&out](const PictureReport& p) {
    const auto of = [](std::size_t part, std::size_t whole) {
      return std::to_string(part) + "/" + std::to_string(whole);
    };
    const std::string ids =
        std::to_string(p.ids_right) + "/" + std::to_string(p.ids_unknown) + "/" + std::to_string(p.ids_wrong);
    line(out, "%-22s %9s %9s %5.2f %5.2f %13s %9s %5.2f %5.2f %13s %7.2f %6zu %7zu", p.name.c_str(),
         of(p.found, p.robots).c_str(), of(p.team_good, p.robots).c_str(), p.team_px.rms, p.team_px.max,
         of(p.identification_good, p.identification).c_str(), ids.c_str(), p.identification_px.rms,
         p.identification_px.max, of(p.balls_good, p.balls).c_str(), p.ball_px.max,
         p.ghosts + p.ball_ghosts + p.wrong_team, p.not_judged + p.ids_not_judged);
  };
  ReliabilityOfScene reliability;
  for (const PictureReport& p : pictures) {
    row(p);
    reliability.add(p.reliability);
  }
  print_reliability({{"sightings", reliability}}, out);
}

std::string to_json(const PoseReport& report, double seen_within_m) {
  return ordered_json{{"frames", report.frames},
                      {"frames_without_result", report.frames_without_result},
                      {"results_without_truth", report.results_without_truth},
                      {"seen_within_m", seen_within_m},
                      {"sightings", json_of(report.sightings)},
                      {"tracks", json_of(report.tracks)},
                      {"spread", json_of(report.spread)}}
             .dump(2) +
         "\n";
}

std::string to_json(const std::vector<PoseSpread>& spread, std::size_t frames) {
  return ordered_json{{"frames", frames}, {"spread", json_of(spread)}}.dump(2) + "\n";
}

std::string to_json(const std::vector<PictureReport>& pictures, const PictureTolerance& tolerance) {
  ordered_json list = ordered_json::array();
  ReliabilityOfScene reliability;
  for (const PictureReport& p : pictures) {
    reliability.add(p.reliability);
    list.push_back({{"name", p.name},
                    {"robots", p.robots},
                    {"found", p.found},
                    {"not_judged", p.not_judged},
                    {"team_good", p.team_good},
                    {"identification", p.identification},
                    {"identification_good", p.identification_good},
                    {"ids_right", p.ids_right},
                    {"ids_unknown", p.ids_unknown},
                    {"ids_wrong", p.ids_wrong},
                    {"ids_not_judged", p.ids_not_judged},
                    {"wrong_team", p.wrong_team},
                    {"ghosts", p.ghosts},
                    {"balls", p.balls},
                    {"balls_found", p.balls_found},
                    {"balls_good", p.balls_good},
                    {"ball_ghosts", p.ball_ghosts},
                    {"team_px", json_of_errors(p.team_px)},
                    {"identification_px", json_of_errors(p.identification_px)},
                    {"ball_px", json_of_errors(p.ball_px)}});
  }
  return ordered_json{{"good_px", tolerance.good_px},
                      {"same_robot_px", tolerance.same_robot_px},
                      {"pictures", list},
                      {"reliability", json_of(reliability)}}
             .dump(2) +
         "\n";
}

}  // namespace touchline::evaluate
