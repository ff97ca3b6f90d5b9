#include "tools/programs/calibrate/field/field_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/config/file_backup.h"
#include "tools/programs/calibrate/field/fit_consistency.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// Distance of a vanishing point beyond which the sides count as parallel.
constexpr double kFar_px = 1e6;

std::string describe(const VanishingPoint& point) {
  if (std::abs(point.w) * kFar_px < 1)
    return formatted("at infinity in direction %.1f degrees", std::atan2(point.y, point.x) * kDegrees);
  return formatted("(%.0f, %.0f)", point.x / point.w, point.y / point.w);
}

// Formats the results of the border search, in the order of Klancar section 6.2.
std::string describe_steps(const BorderSearch& border, const std::optional<VanishingPointModel>& steps) {
  std::string out = formatted("step 1, threshold: the border is brighter than %d of 255, %zu edge pixels along it\n",
                              border.threshold, border.outline.size());
  out += formatted("step 2, Hough transform: sides of %zu, %zu, %zu and %zu pixels (bottom, right, top, left)\n",
                   border.sides[0].votes, border.sides[1].votes, border.sides[2].votes, border.sides[3].votes);
  out += border.h_px < kLargestH_px ? formatted("step 3, three points on each side, eq. (12): H %.0f px\n", border.h_px)
                                    : std::string("step 3, three points on each side, eq. (12): straight, no H\n");
  if (steps) {
    out += formatted(
        "step 4, vanishing points of the straightened sides: %s and %s px from the center; field rotated by %.1f "
        "degrees\n",
        describe(steps->along_x).c_str(), describe(steps->along_y).c_str(), -steps->rotation_rad * kDegrees);
    out += formatted("step 5, eq. (15): p %.3g, q %.3g per px\n", steps->p_per_px, steps->q_per_px);
  }
  out += "corners at";
  for (const PixelPoint& corner : border.corners) {
    out += formatted(" %.1f,%.1f", static_cast<double>(corner.u_px), static_cast<double>(corner.v_px));
  }
  return out + " px\n";
}

const char* remark(HeightSource source) {
  switch (source) {
    case HeightSource::kMeasured:
      return ", from --camera-height";
    case HeightSource::kRules:
      return ", estimated with the league's rules: better measure it and use --camera-height";
    case HeightSource::kSeen:
      break;
  }
  return "";
}

const char* word(HeightSource source) {
  switch (source) {
    case HeightSource::kMeasured:
      return "measured";
    case HeightSource::kRules:
      return "rules";
    case HeightSource::kSeen:
      break;
  }
  return "seen";
}

std::string describe_mark(const Mark& mark) {
  if (mark.radius_m > 0) return formatted("arc around (%.2f, %.2f)", mark.begin_x_m, mark.begin_y_m);
  return formatted("line (%.2f, %.2f) to (%.2f, %.2f)", mark.begin_x_m, mark.begin_y_m, mark.end_x_m, mark.end_y_m);
}

std::string describe_markings(const FieldReport& report) {
  std::size_t used = 0, markings = 0, unseen = 0;
  std::string elsewhere;
  for (std::size_t m = 0; m < report.marks.size(); ++m) {
    if (report.marks[m].side >= 0) continue;
    const MarkReport& mark = report.refinement.marks[m];
    ++markings;
    if (mark.used) {
      ++used;
    } else if (2 * mark.found >= mark.tried_points) {
      elsewhere += formatted("  %s is %.2f px away from its position in the drawing\n",
                             describe_mark(report.marks[m]).c_str(), std::abs(mark.offset_px));
    } else {
      ++unseen;
    }
  }
  if (markings == 0) return "";
  return formatted("markings: %zu of %zu used, %zu not visible\n", used, markings, unseen) + elsewhere;
}

nlohmann::json json_of(const ResidualSummary& spread) { return {{"rms", spread.rms}, {"max", spread.max}}; }

nlohmann::json json_of(const RefinementReport& r) {
  return {
      {"points", r.points},
      {"left_out", r.outliers},
      {"px", {{"rms", r.rms_px}, {"p95", r.p95_px}, {"max", r.max_px}}},
      {"mm", {{"rms", r.rms_mm}, {"p95", r.p95_mm}, {"max", r.max_mm}}},
      {"independent_edge_sigma_px", r.edge_sigma_px},
      {"sigma",
       {{"height_m", r.sigma.height_m},
        {"x_m", r.sigma.x_m},
        {"y_m", r.sigma.y_m},
        {"tilt_rad", r.sigma.tilt_rad},
        {"focal_px", r.sigma.focal_px},
        {"center_u_px", r.sigma.center_u_px},
        {"center_v_px", r.sigma.center_v_px},
        {"floor_center_mm", r.sigma.floor_center_mm},
        {"floor_corner_mm", r.sigma.floor_corner_mm},
        {"robot_top_corner_mm", r.sigma.top_corner_mm}}},
      {"height_of_the_picture_alone",
       {{"height_m", r.height.height_m}, {"sigma_m", r.height.sigma_m}, {"chi_square_of_given", r.height.chi_square}}},
      {"strain", r.sigma.lens_chi_square}};
}

}  // namespace

std::string residual_text(const FieldReport& report) {
  const RefinementReport& r = report.refinement;
  const FieldFit& fit = report.fit;
  if (r.points == 0 && !fit.has_distortion) {
    return formatted("%zu points: too few to measure the accuracy (at the points %.2f px RMS, %.2f mm RMS)",
                     report.points.size(), fit.residual_px.rms, fit.residual_mm.rms);
  }
  if (r.points == 0) {
    return formatted("%zu points: %.2f px RMS, %.2f px max; %.2f mm RMS, %.2f mm max", report.points.size(),
                     fit.residual_px.rms, fit.residual_px.max, fit.residual_mm.rms, fit.residual_mm.max);
  }
  return formatted(
      "%zu points of border and markings: %.2f px RMS, p95 %.2f, max %.2f; %.2f mm RMS, p95 %.2f, max %.2f (%zu left "
      "out)",
      r.points, r.rms_px, r.p95_px, r.max_px, r.rms_mm, r.p95_mm, r.max_mm, r.outliers);
}

namespace {

// Names the parameters that so few points do not determine, and says how to measure them.
std::string describe_unknowns(const FieldReport& report) {
  const FieldFit& fit = report.fit;
  if (report.refinement.points > 0 || fit.has_distortion) return "";
  std::string out = formatted(
      "unknown: lens distortion, which is assumed to be zero; if the lens has k1 = %.1f, as many wide lenses have, the "
      "field is up to %.0f mm off between the points\n",
      kWideLensK1, 1e3 * distortion_effect_m(fit.camera, report.points));
  if (report.height == HeightSource::kMeasured) {
    out += formatted(
        "unknown: the height of %.3f m is as given, and the tilt follows from it; errors of the clicks change the tilt "
        "and remain unnoticed\n",
        fit.height_m);
  } else {
    out += formatted(
        "unknown: height and tilt follow from the perspective alone; the points leave the height uncertain by "
        "%.2f m (standard deviation), and a robot's position by as many percent; measure the height "
        "(--camera-height)\n",
        fit.height_sigma_m);
  }
  return out + formatted(
                   "to measure them: let the program find the border (no --corners), or give at least %zu points, "
                   "some in the middle of the sides (--point)\n",
                   kPointsForDistortion);
}

}  // namespace

double distortion_effect_m(const CameraParameters& camera, const std::vector<FloorPoint>& points) {
  const FullModelParameters& full = camera.full;
  const double focal = static_cast<double>(full.fx_px);
  const auto radius = [&](double u_px, double v_px) {
    return std::hypot(u_px - static_cast<double>(full.cx_px), v_px - static_cast<double>(full.cy_px)) / focal;
  };
  // On average the fit keeps the points in place; between them, the third-order term of Brown's model remains.
  double square = 0, mid_u = 0, mid_v = 0;
  for (const FloorPoint& p : points) {
    square += std::pow(radius(p.u_px, p.v_px), 2) / static_cast<double>(points.size());
    mid_u += p.u_px / static_cast<double>(points.size());
    mid_v += p.v_px / static_cast<double>(points.size());
  }
  const double height = static_cast<double>(full.position_m[2]);
  double most = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FloorPoint &a = points[i], &b = points[(i + 1) % points.size()];
    for (const auto& [u, v] : {std::pair{(a.u_px + b.u_px) / 2, (a.v_px + b.v_px) / 2},
                               std::pair{(a.u_px + mid_u) / 2, (a.v_px + mid_v) / 2}}) {
      const double r = radius(u, v);
      most = std::max(most, std::abs(kWideLensK1) * r * std::abs(r * r - square) * height);
    }
  }
  return most;
}

std::string text_of(const FieldReport& report) {
  const FieldFit& fit = report.fit;
  const CameraUncertainty& sigma = report.refinement.sigma;
  const bool refined = report.refinement.points > 0;
  const FullModelParameters& full = fit.camera.full;
  const auto value = [](float number) { return static_cast<double>(number); };
  std::string out = report.border ? describe_steps(*report.border, report.steps) : "";
  const std::string assumption = assumption_of(report);
  out += formatted("camera %.3f m (+- %.3f) above the floor, %.1f degrees off the vertical%s%s\n", fit.height_m,
                   fit.height_sigma_m, fit.tilt_rad * kDegrees, remark(report.height),
                   refined ? ("; " + describe(report.refinement.height)).c_str() : "");
  out += residual_text(report) + "\n";
  if (refined) {
    out += formatted(
        "standard deviations: place %.1f, %.1f mm, tilt %.2f degrees, focal length %.1f px, center %.1f, %.1f px%s;\n"
        "  floor %.2f mm in the field's center, %.2f mm in its corners; a robot's top in a corner %.1f mm%s\n",
        1e3 * sigma.x_m, 1e3 * sigma.y_m, sigma.tilt_rad * kDegrees, sigma.focal_px, sigma.center_u_px,
        sigma.center_v_px, assumption.c_str(), sigma.floor_center_mm, sigma.floor_corner_mm, sigma.top_corner_mm,
        assumption.c_str());
    out += describe_markings(report);
  }
  for (const std::string& doubt : report.doubts) out += "warning: " + doubt + "\n";
  out += describe_unknowns(report);
  if (!report.unrefined.empty()) out += "the camera model was not refined along the border: " + report.unrefined + "\n";
  out +=
      fit.has_distortion
          ? formatted("lens: focal lengths %.1f and %.1f px, center %.1f, %.1f px, k %.4f %.4f %.4f, p %.5f %.5f\n",
                      value(full.fx_px), value(full.fy_px), value(full.cx_px), value(full.cy_px), value(full.k1),
                      value(full.k2), value(full.k3), value(full.p1), value(full.p2))
          : formatted("lens: focal length %.1f px; to measure distortion, the border or two more points are needed\n",
                      value(full.fx_px));
  if (report.steps) {
    out += formatted("paper's model without refinement: %.2f mm RMS, %.2f mm max\n", report.steps_mm.rms,
                     report.steps_mm.max);
  }
  out +=
      formatted("paper's model, eq. (12)-(15)%s: H %.0f px, p %.3g, q %.3g per px", refined ? ", refined" : "",
                value(fit.camera.paper.focal_px), value(fit.camera.paper.p_per_px), value(fit.camera.paper.q_per_px));
  out += refined || fit.has_distortion
             ? formatted("; %.2f mm RMS, %.2f mm max\n", fit.paper_residual_mm.rms, fit.paper_residual_mm.max)
             : std::string("\n");
  if (refined) {
    out += formatted("full model, refined: %.2f mm RMS, %.2f mm max\n", report.refinement.rms_mm,
                     report.refinement.max_mm);
  }
  return out;
}

Result<void> write_json(const FieldReport& report, const std::string& path) {
  const FieldFit& fit = report.fit;
  const FullModelParameters& full = fit.camera.full;
  nlohmann::json out = {{"height_m", fit.height_m},
                        {"height_sigma_m", fit.height_sigma_m},
                        {"height_from", word(report.height)},
                        {"doubts", report.doubts},
                        {"tilt_rad", fit.tilt_rad},
                        {"position_m", full.position_m},
                        {"focal_px", {full.fx_px, full.fy_px}},
                        {"center_px", {full.cx_px, full.cy_px}},
                        {"distortion", {full.k1, full.k2, full.p1, full.p2, full.k3}},
                        {"paper",
                         {{"h_px", fit.camera.paper.focal_px},
                          {"p_per_px", fit.camera.paper.p_per_px},
                          {"q_per_px", fit.camera.paper.q_per_px},
                          {"mm", json_of(fit.paper_residual_mm)}}},
                        {"seconds", report.seconds}};
  if (report.refinement.points > 0) {
    out["full"] = json_of(report.refinement);
    for (std::size_t m = 0; m < report.marks.size(); ++m) {
      const MarkReport& mark = report.refinement.marks[m];
      out["marks"].push_back({{"side", report.marks[m].side},
                              {"tried", mark.tried_points},
                              {"found", mark.found},
                              {"offset_px", mark.offset_px},
                              {"used", mark.used}});
    }
  } else {
    out["points"] = {
        {"count", report.points.size()}, {"px", json_of(fit.residual_px)}, {"mm", json_of(fit.residual_mm)}};
    out["not_refined"] = report.unrefined;
  }
  if (report.border) {
    const BorderSearch& border = *report.border;
    auto& steps = out["steps"];
    steps = {{"threshold", border.threshold}, {"edge_pixels", border.outline.size()}, {"h_px", border.h_px}};
    for (const HoughLine& side : border.sides) steps["side_votes"].push_back(side.votes);
    for (const PixelPoint& corner : border.corners) steps["corners_px"].push_back({corner.u_px, corner.v_px});
    if (report.steps) {
      const VanishingPointModel& s = *report.steps;
      steps["vanishing_points"] = {{s.along_x.x, s.along_x.y, s.along_x.w}, {s.along_y.x, s.along_y.y, s.along_y.w}};
      steps["rotation_rad"] = s.rotation_rad;
      steps["p_per_px"] = s.p_per_px;
      steps["q_per_px"] = s.q_per_px;
      steps["mm"] = json_of(report.steps_mm);
    }
  }
  return config::replace_file(path, out.dump(1) + "\n");
}

}  // namespace touchline::calibrate
