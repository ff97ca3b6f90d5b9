#include "tools/programs/setup/noise_step.h"

#include <numbers>

#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::setup {
namespace {

constexpr double kMillimeter = 1e3, kDegree = 180.0 / std::numbers::pi;

nlohmann::json entry_json(const config::NoiseEntry& entry) {
  return {{"robot_position_mm", entry.robot_position_m * kMillimeter},
          {"robot_heading_deg", entry.robot_heading_rad * kDegree},
          {"ball_position_mm", entry.ball_position_m * kMillimeter}};
}

}  // namespace

Result<void> write_noise(const calibrate::NoiseRecorder& recorder, const JobInput& input, const JobOutput& output) {
  TOUCHLINE_TRY_ASSIGN(const calibrate::NoiseReport report, recorder.report());
  TOUCHLINE_TRY(calibrate::write_sections(input.path(input.state.files.venue),
                                          {calibrate::section_of("noise", report.entry, "")}));
  nlohmann::json objects = nlohmann::json::array();
  for (const calibrate::ObjectNoise& one : report.objects) {
    objects.push_back({{"name", one.name},
                       {"sightings", one.sightings},
                       {"position_mm", one.position_m * kMillimeter},
                       {"heading_deg", one.heading_rad > 0 ? nlohmann::json(one.heading_rad * kDegree) : nullptr}});
  }
  const auto former = input.state.measured.find("robots");
  nlohmann::json measured = former == input.state.measured.end() ? nlohmann::json::object() : *former;
  measured["noise"] = {{"objects", objects},
                       {"left_out", report.left_out},
                       {"has_ball", report.has_ball},
                       {"hidden", entry_json(report.entry)},
                       {"before", entry_json(recorder.before())}};
  output.measured(measured);
  return {};
}

}  // namespace touchline::setup
