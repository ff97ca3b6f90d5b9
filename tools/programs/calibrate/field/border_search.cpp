#include "tools/programs/calibrate/field/border_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// For each further fit, the distance from a straightened side within which its points are collected.
constexpr std::array<double, 3> kCollect_px{14.0, 6.0, 3.0};
constexpr std::array<double, 6> kThresholds{0.7, 1.0, 1.3, 1.7, 2.2, 2.8};

Eigen::Vector2d rectified(const Eigen::Vector2d& pixel, const Eigen::Vector2d& center, double h_px) {
  const Eigen::Vector2d away = pixel - center;
  const double r = away.norm() / h_px;
  return r < 1e-9 ? pixel : Eigen::Vector2d(center + away * (std::sinh(r) / r));
}

Eigen::Vector2d distorted(const Eigen::Vector2d& point, const Eigen::Vector2d& center, double h_px) {
  const Eigen::Vector2d away = point - center;
  const double r = away.norm() / h_px;
  return r < 1e-9 ? point : Eigen::Vector2d(center + away * (std::asinh(r) / r));
}

double off(const HoughLine& line, double u, double v) {
  return u * std::cos(line.angle_rad) + v * std::sin(line.angle_rad) - line.distance_px;
}

// Fits a line by total least squares to the points near `line`; returns `line` if there are too few.
HoughLine refitted(const std::vector<Eigen::Vector2d>& points, const HoughLine& line, double within_px) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> near;
  for (const Eigen::Vector2d& p : points) {
    if (std::abs(off(line, p.x(), p.y())) < within_px) near.push_back(p);
  }
  if (near.size() < kMinVotes / 2) return line;
  for (const Eigen::Vector2d& p : near) mean += p / static_cast<double>(near.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : near) spread += (p - mean) * (p - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(spread);  // closed form; the iterative solver takes seconds to compile
  const Eigen::Vector2d normal = axes.eigenvectors().col(0);
  return {std::atan2(normal.y(), normal.x()), normal.dot(mean), near.size()};
}

std::optional<Eigen::Vector2d> crossing(const HoughLine& a, const HoughLine& b) {
  Eigen::Matrix2d normals;
  normals << std::cos(a.angle_rad), std::sin(a.angle_rad), std::cos(b.angle_rad), std::sin(b.angle_rad);
  if (std::abs(normals.determinant()) < 0.1) return std::nullopt;
  return Eigen::Vector2d(normals.inverse() * Eigen::Vector2d(a.distance_px, b.distance_px));
}

// Corners in the order of fit_field(): -x-y is the intersection of left and bottom, then counter-clockwise seen from
// above. Sides in the order of hough_sides().
constexpr std::array<std::array<std::size_t, 2>, 4> kCornerSides{{{3, 0}, {0, 1}, {1, 2}, {2, 3}}};

// A lens with H of eq. (12), and the scale at which its straightened picture keeps its size.
struct WideLens {
  double h_px = 0;  // 0: the sides are almost straight in the picture itself
  double scale = 1;
};

WideLens wide_lens(double h_px, int width_px, int height_px) {
  const double r = 0.5 * std::hypot(width_px, height_px) / h_px;
  return {h_px, r / std::sinh(r)};
}

Eigen::Vector2d straightened(const Eigen::Vector2d& pixel, const Eigen::Vector2d& center, const WideLens& lens) {
  return center + lens.scale * (rectified(pixel, center, lens.h_px) - center);
}

Eigen::Vector2d bent(const Eigen::Vector2d& point, const Eigen::Vector2d& center, const WideLens& lens) {
  if (lens.h_px <= 0) return point;
  return distorted(center + (point - center) / lens.scale, center, lens.h_px);
}

// Returns the area of the quadrilateral in the picture; 0 if sides do not intersect, or intersect far outside the
// picture.
double area_of(const std::array<HoughLine, 4>& sides, const WideLens& lens, int width_px, int height_px) {
  constexpr double kBeyond = 0.1;
  const Eigen::Vector2d center(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = crossing(sides[kCornerSides[i][0]], sides[kCornerSides[i][1]]);
    const auto outside = [](double at, double size) { return at < -kBeyond * size || at > (1 + kBeyond) * size; };
    if (!corner) return 0;
    corners[i] = bent(*corner, center, lens);
    if (outside(corners[i].x(), width_px) || outside(corners[i].y(), height_px)) return 0;
  }
  double twice = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

// The four sides of an outline and the share of its pixels that lie on them.
struct SideSearch {
  std::array<HoughLine, 4> sides;
  WideLens lens;
  double share = 0;
};

// Finds the sides in the picture, and in pictures straightened for wide lenses: the lens with which most pixels lie on
// straight sides is the right one (the plumb-line method, Brown 1971). A wide lens must be clearly better to be chosen.
SideSearch find_sides(const std::vector<OutlinePixel>& outline, int width_px, int height_px) {
  constexpr std::array<double, 7> kWideH_widths{1.1, 0.9, 0.75, 0.63, 0.53, 0.45, 0.38};
  constexpr double kClearlyBetter = 1.15;
  const Eigen::Vector2d center(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  const auto share_of = [&](const std::array<HoughLine, 4>& sides) {
    std::size_t votes = 0;
    for (const HoughLine& side : sides) votes += side.votes;
    return static_cast<double>(votes) / static_cast<double>(outline.size());
  };
  SideSearch best;
  if (hough_sides(outline, width_px, height_px, best.sides)) best.share = share_of(best.sides);
  double to_beat = kClearlyBetter * best.share;
  for (const double widths : kWideH_widths) {
    const WideLens lens = wide_lens(widths * width_px, width_px, height_px);
    std::vector<OutlinePixel> straight;
    for (const OutlinePixel& p : outline) {
      const Eigen::Vector2d at = straightened({p.u_px, p.v_px}, center, lens);
      straight.push_back({at.x(), at.y()});
    }
    std::array<HoughLine, 4> sides;
    if (!hough_sides(straight, width_px, height_px, sides) || share_of(sides) <= to_beat) continue;
    best = {sides, lens, share_of(sides)};
    to_beat = best.share;
  }
  return best;
}

// Fits lines to the pixels of each side, straightened with this H; returns the mean square distance in pixels of the
// scaled picture.
double fit_sides(const std::array<std::vector<Eigen::Vector2d>, 4>& pixels, const WideLens& lens,
                 const Eigen::Vector2d& center, std::array<HoughLine, 4>& lines) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<Eigen::Vector2d> straight;
    for (const Eigen::Vector2d& p : pixels[i]) straight.push_back(straightened(p, center, lens));
    lines[i] = refitted(straight, lines[i], std::numeric_limits<double>::infinity());
    for (const double within : kCollect_px) lines[i] = refitted(straight, lines[i], within);
    for (const Eigen::Vector2d& p : straight) {
      // The distance is limited, so that pixels of goals and markings do not bend the side.
      const double distance = std::min(kCollect_px.back(), std::abs(off(lines[i], p.x(), p.y())));
      sum += distance * distance;
      count += 1;
    }
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::infinity();
}

// Refines H of a wide lens and the straightened sides by a golden-section search for the straightest sides.
WideLens refine_wide_lens(const std::vector<OutlinePixel>& outline, const SideSearch& start, int width_px,
                          int height_px, std::array<HoughLine, 4>& lines) {
  const Eigen::Vector2d center(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  std::array<std::vector<Eigen::Vector2d>, 4> pixels;
  for (const OutlinePixel& p : outline) {
    const Eigen::Vector2d at = straightened({p.u_px, p.v_px}, center, start.lens);
    for (std::size_t i = 0; i < 4; ++i) {
      if (std::abs(off(start.sides[i], at.x(), at.y())) < kCollect_px[0]) pixels[i].emplace_back(p.u_px, p.v_px);
    }
  }
  const auto cost = [&](double h_px) {
    std::array<HoughLine, 4> tried = start.sides;
    return fit_sides(pixels, wide_lens(h_px, width_px, height_px), center, tried);
  };
  double low = 0.8 * start.lens.h_px, high = 1.25 * start.lens.h_px;
  const double golden = 1 / std::numbers::phi;
  for (int i = 0; i < 25; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (cost(a) < cost(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  const WideLens lens = wide_lens(0.5 * (low + high), width_px, height_px);
  lines = start.sides;
  (void)fit_sides(pixels, lens, center, lines);
  // Undo the scale of the straightened picture in the distances from the center.
  for (HoughLine& line : lines) line.distance_px -= off(line, center.x(), center.y()) * (1 / lens.scale - 1);
  return lens;
}

}  // namespace

double h_of_three_points(const std::vector<OutlinePixel>& outline, const HoughLine& side, int width_px, int height_px) {
  const Eigen::Vector2d center(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  // Divides the side into ten parts and takes the median offset of the points in each.
  const Eigen::Vector2d along(-std::sin(side.angle_rad), std::cos(side.angle_rad));
  std::vector<std::pair<double, double>> near;  // (position along the side, offset)
  for (const OutlinePixel& p : outline) {
    const double distance = off(side, p.u_px, p.v_px);
    if (std::abs(distance) < kCollect_px[0]) near.emplace_back(along.dot(Eigen::Vector2d(p.u_px, p.v_px)), distance);
  }
  if (near.size() < kMinVotes) return kLargestH_px;
  std::sort(near.begin(), near.end());
  const auto place = [&](double from, double to) {
    const auto index = [&near](double share) {
      return static_cast<std::size_t>(std::lround(share * static_cast<double>(near.size() - 1)));
    };
    const std::size_t begin = index(from), end = index(to);
    std::vector<double> offsets;
    for (std::size_t i = begin; i < end; ++i) offsets.push_back(near[i].second);
    const double a = near[(begin + end) / 2].first, o = statistics::median(offsets);
    const Eigen::Vector2d normal(std::cos(side.angle_rad), std::sin(side.angle_rad));
    return Eigen::Vector2d((side.distance_px + o) * normal + a * along);
  };
  // Leave out the ends, where the adjacent sides begin.
  const std::array<Eigen::Vector2d, 3> points{place(0.07, 0.17), place(0.45, 0.55), place(0.83, 0.93)};
  const auto bow = [&](double curvature) {
    const double h = 1.0 / curvature;
    const Eigen::Vector2d a = rectified(points[0], center, h), b = rectified(points[1], center, h),
                          c = rectified(points[2], center, h);
    const Eigen::Vector2d ab = b - a, ac = c - a;
    return ab.x() * ac.y() - ab.y() * ac.x();
  };
  // Collinearity changes its sign once between no distortion and a fisheye lens.
  double low = 1.0 / kLargestH_px, high = 2.5 / std::hypot(width_px, height_px);
  if (bow(low) * bow(high) > 0) return kLargestH_px;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (bow(low) * bow(middle) <= 0 ? high : low) = middle;
  }
  return 2.0 / (low + high);
}

// Finds H from the bend of the sides, then straightens the sides with it.
static void straighten_sides(const Eigen::Vector2d& center, int width, int height, BorderSearch& out) {
  // Klancar uses only the longest side, but a goal or a marking at its ends can spoil it. The bend of eq. (12) is
  // proportional to 1 / H^2 to first order; the second largest bend of the four sides is used.
  std::array<double, 4> bend{};
  for (std::size_t i = 0; i < 4; ++i) {
    bend[i] = std::pow(h_of_three_points(out.outline, out.sides[i], width, height), -2);
  }
  std::sort(bend.begin(), bend.end());
  out.h_px = std::sqrt(1 / bend[2]);
  std::vector<Eigen::Vector2d> straight;
  for (const OutlinePixel& p : out.outline) straight.push_back(rectified({p.u_px, p.v_px}, center, out.h_px));
  for (std::size_t i = 0; i < 4; ++i) {
    // The middle of the side gives the position of the straightened line; its ends have moved.
    const HoughLine& side = out.sides[i];
    const Eigen::Vector2d normal(std::cos(side.angle_rad), std::sin(side.angle_rad));
    const Eigen::Vector2d nearest = center + (side.distance_px - normal.dot(center)) * normal;
    out.straight_sides[i] = {side.angle_rad, normal.dot(rectified(nearest, center, out.h_px)), side.votes};
    for (const double within : kCollect_px) out.straight_sides[i] = refitted(straight, out.straight_sides[i], within);
  }
}

Result<void> find_border(const hal::Picture& picture, BorderSearch& out) {
  out = {};
  const int width = static_cast<int>(picture.width_px), height = static_cast<int>(picture.height_px);
  const int otsus = brightness_threshold(picture);
  Error error =
      failure(ErrorCode::kNotFound,
              "no bright border surrounds a tenth of the picture (threshold %d of 255): is the border cut off?", otsus);
  // If lamps make parts of the floor as bright as the border elsewhere, another threshold may separate them. The best
  // threshold leaves most border pixels on the four sides and has not lost the half of the field behind the center
  // line.
  double best = 0;
  SideSearch found;
  for (const double factor : kThresholds) {
    BorderSearch attempt;
    attempt.threshold = std::clamp(static_cast<int>(std::lround(factor * otsus)), 1, 250);
    attempt.outline = border_outline(picture, attempt.threshold);
    if (attempt.outline.empty()) continue;
    const SideSearch sides = find_sides(attempt.outline, width, height);
    if (sides.share <= 0) {
      if (best <= 0) {
        error.text =
            "the bright region around the field does not have four sides that are straight, with or without a wide "
            "lens";
      }
      continue;
    }
    const double merit = sides.share * area_of(sides.sides, sides.lens, width, height);
    if (merit <= best) continue;
    best = merit;
    attempt.sides = sides.sides;
    found = sides;
    out = std::move(attempt);
  }
  if (best <= 0) return error;
  const Eigen::Vector2d center(0.5 * (width - 1), 0.5 * (height - 1));
  std::array<HoughLine, 4>& lines = out.straight_sides;
  if (found.lens.h_px > 0) {
    out.h_px = refine_wide_lens(out.outline, found, width, height, lines).h_px;
  } else {
    straighten_sides(center, width, height, out);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = crossing(lines[kCornerSides[i][0]], lines[kCornerSides[i][1]]);
    if (!corner) {
      return Error{ErrorCode::kNotFound, "two adjacent sides of the border are parallel"};
    }
    out.straight_corners[i] = {static_cast<float>(corner->x()), static_cast<float>(corner->y())};
    const Eigen::Vector2d pixel = distorted(*corner, center, out.h_px);
    out.corners[i] = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  }
  Result<void> checked = check_corners(out.corners);
  if (!checked.ok()) return Error{ErrorCode::kNotFound, checked.error().text};
  return {};
}

}  // namespace touchline::calibrate
