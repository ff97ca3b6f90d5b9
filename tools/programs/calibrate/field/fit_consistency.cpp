#include "tools/programs/calibrate/field/fit_consistency.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

// Number of standard deviations from a prior beyond which a value is unusual.
constexpr double kUnusual = 2.0;

// Largest distance from its drawing at which a marking is searched for: if the border is a plinth twice as wide as
// MiroSot's walls, the center circle is off by this distance. The distance is smaller on small fields and around small
// circles, where other marks are near.
constexpr double kBeside_m = 0.06, kBesideOfField = 0.15, kBesideOfRadius = 0.3;
// Spacing of the points along a marking, as in the refinement.
constexpr double kSpacing_px = 3.0;
// A marking counts as seen if this share of its points lies within one pixel of a smooth curve.
constexpr double kSeenShare = 0.6, kOnCurve_px = 1.0;

// A marking seen in the picture, and its distance from the drawing.
struct SeenMarking {
  double rms_m = 0, max_m = 0, share = 0;
};

// Basis functions of a line that is displaced and turned, or of a circle with another center, radius and aspect ratio.
// `part`: position along the mark, 0 to 1.
constexpr Eigen::Index kMaxTerms = 5;
using Terms = Eigen::Matrix<double, kMaxTerms, 1>;
Terms curve_terms(bool is_arc, double part) {
  Terms terms = Terms::Zero();
  terms(0) = 1;
  if (!is_arc) {
    terms(1) = 2 * part - 1;
    return terms;
  }
  const double angle = 2 * std::numbers::pi * part;
  terms << 1, std::cos(angle), std::sin(angle), std::cos(2 * angle), std::sin(2 * angle);
  return terms;
}

// Returns the bright curve along this mark, if one is at most kBeside_m away. Fits by iteratively reweighted least
// squares with a loss that narrows from the whole reach to a pixel.
std::optional<SeenMarking> seen_near(const LightPicture& picture, const CameraModel& camera, const Mark& mark,
                                     double smaller_side_m) {
  double reach_m = std::min(kBeside_m, kBesideOfField * smaller_side_m);
  if (mark.radius_m > 0) reach_m = std::min(reach_m, kBesideOfRadius * mark.radius_m);
  const MarkPlace middle = place_on(mark, length_of(mark) / 2);
  const auto scale = static_cast<double>(
      camera.scale_px_per_m({static_cast<float>(middle.x_m), static_cast<float>(middle.y_m)}, 0.0f));
  constexpr double kMinReach_px = 8.0;
  const double reach_px = std::max(kMinReach_px, reach_m * scale);
  std::vector<std::size_t> tried;
  const std::vector<MarkPoint> points = find_marks(picture, camera, {mark}, kSpacing_px, reach_px, &tried);
  if (static_cast<double>(points.size()) < kSeenShare * static_cast<double>(tried[0])) return std::nullopt;
  std::vector<double> offsets;
  std::vector<Terms> terms;
  for (const MarkPoint& p : points) {
    const PixelPoint at = camera.to_pixel({static_cast<float>(p.x_m), static_cast<float>(p.y_m)}, 0.0f);
    offsets.push_back((p.u_px - static_cast<double>(at.u_px)) * p.across_u +
                      (p.v_px - static_cast<double>(at.v_px)) * p.across_v);
    const double part = mark.radius_m > 0
                            ? std::atan2(p.y_m - mark.begin_y_m, p.x_m - mark.begin_x_m) / (2 * std::numbers::pi)
                            : std::hypot(p.x_m - mark.begin_x_m, p.y_m - mark.begin_y_m) / length_of(mark);
    terms.push_back(curve_terms(mark.radius_m > 0, part));
  }
  Terms curve = Terms::Zero();
  std::vector<double> sorted = offsets;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  curve(0) = sorted[sorted.size() / 2];
  for (double loss_px = reach_px; loss_px > kOnCurve_px / 4; loss_px *= 0.8) {
    // Terms that do not apply to a line stay zero.
    Eigen::Matrix<double, kMaxTerms, kMaxTerms> normal = 1e-6 * Eigen::Matrix<double, kMaxTerms, kMaxTerms>::Identity();
    Terms right = Terms::Zero();
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const double residual = (offsets[i] - terms[i].dot(curve)) / loss_px;
      const double weight = 1 / (1 + residual * residual);
      normal += weight * terms[i] * terms[i].transpose();
      right += weight * offsets[i] * terms[i];
    }
    curve = normal.ldlt().solve(right);
  }
  SeenMarking seen;
  std::size_t near = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double at = terms[i].dot(curve);
    near += std::abs(offsets[i] - at) < kOnCurve_px ? 1u : 0u;
    seen.rms_m += at * at / static_cast<double>(offsets.size());
    seen.max_m = std::max(seen.max_m, std::abs(at) / scale);
  }
  seen.rms_m = std::sqrt(seen.rms_m) / scale;
  seen.share = static_cast<double>(near) / static_cast<double>(tried[0]);
  if (seen.share < kSeenShare) return std::nullopt;
  return seen;
}

// Returns whether the mark is a line through the center of the field from side to side, or a circle around the center.
bool is_central(const Mark& mark) {
  constexpr double kAtCenter_m = 1e-3;
  if (mark.side >= 0 || mark.kind != MarkKind::kLine) return false;
  if (mark.radius_m > 0) {
    return std::hypot(mark.begin_x_m, mark.begin_y_m) < kAtCenter_m &&
           length_of(mark) > 0.99 * 2 * std::numbers::pi * mark.radius_m;
  }
  return mark.early && std::hypot(mark.begin_x_m + mark.end_x_m, mark.begin_y_m + mark.end_y_m) < kAtCenter_m;
}

}  // namespace

bool shows_height(const HeightEvidence& evidence) { return evidence.sigma_m < kShownHeight * evidence.height_m; }

bool contradicts(const HeightEvidence& evidence) {
  return shows_height(evidence) && evidence.chi_square > kImpossibleHeight;
}

std::string describe(const HeightEvidence& evidence) {
  if (shows_height(evidence)) {
    return formatted("the picture alone says %.2f m (+- %.2f)", evidence.height_m, evidence.sigma_m);
  }
  return "the picture alone does not show the height: straight above the field, a camera of twice the focal length "
         "sees the same from twice as high";
}

std::string assumption_of(const FieldReport& report) {
  const HeightEvidence& evidence = report.refinement.height;
  if (report.height == HeightSource::kMeasured) return " if the height is right";
  // The priors have contributed if the result's standard deviation is below this share of the picture's own.
  constexpr double kAlone = 0.9;
  if (report.refinement.points == 0 || report.fit.height_sigma_m > kAlone * evidence.sigma_m) return "";
  return report.height == HeightSource::kRules ? " if lens and height are as usual in this league"
                                               : " if the lens is a usual one";
}

std::vector<std::string> height_doubts(const FieldReport& report, const std::optional<HeightPrior>& rules,
                                       int width_px) {
  std::vector<std::string> out;
  if (report.height != HeightSource::kMeasured) return out;
  const HeightEvidence& evidence = report.refinement.height;
  if (shows_height(evidence) && evidence.chi_square > kDoubtfulHeight) {
    out.push_back(formatted("the height given leads to %.2f m, but %s: measure it again", report.fit.height_m,
                            describe(evidence).c_str()));
  }
  const double widths = static_cast<double>(report.fit.camera.full.fx_px) / width_px;
  if (std::abs(std::log(widths / kFocalWidths)) > kUnusual * kFocalSigma) {
    constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
    const double seen = 2 * std::atan(0.5 / widths) * kDegreesPerRadian;
    out.push_back(
        formatted("with the height given, %.2f m, the lens sees %.0f degrees of the picture's width; lenses above "
                  "fields see 45 to 100 degrees: measure the height again, or compare with the lens's data sheet",
                  report.fit.height_m, seen));
  }
  if (rules && std::abs(report.fit.height_m - rules->height_m) > kUnusual * rules->sigma_m) {
    out.push_back(formatted("the height given is %.2f m; in this league cameras hang at %.1f m (+- %.1f)",
                            report.fit.height_m, rules->height_m, rules->sigma_m));
  }
  return out;
}

Result<void> check_center_markings(const LightPicture& picture, const FieldReport& report, double tolerance_m) {
  CameraModel camera;
  CameraParameters parameters = report.fit.camera;
  parameters.kind = CameraModelKind::kFull;
  if (!camera.configure(parameters).ok()) return {};
  double half_x = 0, half_y = 0;
  for (const Mark& mark : report.marks) {
    if (mark.side < 0) continue;
    half_x = std::max({half_x, std::abs(mark.begin_x_m), std::abs(mark.end_x_m)});
    half_y = std::max({half_y, std::abs(mark.begin_y_m), std::abs(mark.end_y_m)});
  }
  const double smaller_m = 2 * std::min(half_x, half_y);
  const auto scale = static_cast<double>(camera.scale_px_per_m({0.0f, 0.0f}, 0.0f));
  const double most_m = std::max(kMaxMarkingOffset_m, kOnCurve_px / scale) + tolerance_m;
  for (std::size_t m = 0; m < report.marks.size(); ++m) {
    const Mark& mark = report.marks[m];
    const bool used = report.refinement.points > 0 && report.refinement.marks[m].used;
    if (used || !is_central(mark)) continue;
    const char* const name = mark.radius_m > 0 ? "circle" : "line";
    if (const auto seen = seen_near(picture, camera, mark, smaller_m)) {
      if (seen->rms_m <= most_m) continue;
      return failure(ErrorCode::kOutOfRange,
                     "the center %s is seen %.0f mm beside its place in the drawing (RMS; at most %.0f mm): is the "
                     "bright region the border of the field, not a plinth or the top of a wall, and are length and "
                     "width right? If the lines of this field differ from the drawing, ignore them (--drawing none; on "
                     "the Set up page: Ignore lines inside the border)",
                     name, 1e3 * seen->rms_m, 1e3 * seen->max_m);
    }
    if (mark.radius_m > 0) continue;
    // Try the other direction too, from border to border.
    Mark turned = mark;
    const bool across = std::abs(mark.end_y_m - mark.begin_y_m) > std::abs(mark.end_x_m - mark.begin_x_m);
    turned.begin_x_m = across ? -half_x : 0;
    turned.end_x_m = across ? half_x : 0;
    turned.begin_y_m = across ? 0 : -half_y;
    turned.end_y_m = across ? 0 : half_y;
    const auto seen = seen_near(picture, camera, turned, smaller_m);
    if (!seen || seen->rms_m > kBeside_m) continue;
    return failure(
        ErrorCode::kInconsistent,
        "the center line is seen %s the field instead of %s it: are length and width exchanged? If the lines "
        "of this field differ from the drawing, ignore them (--drawing none; on the Set up page: Ignore lines inside "
        "the border)",
        across ? "along" : "across", across ? "across" : "along");
  }
  return {};
}

}  // namespace touchline::calibrate
