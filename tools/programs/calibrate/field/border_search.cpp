#include "tools/programs/calibrate/field/border_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAngles = 360;  // steps of half a degree
// Lens distortion bends the sides: tolerance of the line fit in a picture of width kUsualWidth_px; it grows in
// proportion to the width.
constexpr int kUsualBend_px = 3, kUsualWidth_px = 640;
// Tolerance of right angles: perspective turns the rectangle into a general quadrilateral.
constexpr double kSkew_rad = 0.45;
// The points of each straightened side are collected and fitted again within these distances.
constexpr std::array<double, 3> kCollect_px{14.0, 6.0, 3.0};
// The sides of a rectangle are 1 to 1.7 standard deviations of its outline away from its center; the markings inside
// are closer.
constexpr double kLeastDeviations = 0.8;
constexpr std::array<double, 6> kThresholds{0.7, 1.0, 1.3, 1.7, 2.2, 2.8};
constexpr double kLeastEnclosed = 0.1;
// The regions between the lines of the field are larger; specks and letters are smaller.
constexpr double kLeastArea = 0.001;
constexpr std::size_t kLeastVotes = 60;

std::vector<std::uint8_t> brightness(const hal::Picture& picture) {
  std::vector<std::uint8_t> luma(std::size_t{picture.width_px} * picture.height_px);
  for (std::size_t i = 0; i < luma.size(); ++i) {
    const std::uint8_t* rgb = &picture.rgb8[3 * i];
    // White is bright in all channels, colored objects are not.
    luma[i] = std::min({rgb[0], rgb[1], rgb[2]});
  }
  return luma;
}

int otsu(const std::vector<std::uint8_t>& values) {
  std::array<double, 256> histogram{};
  for (const std::uint8_t value : values) ++histogram[value];
  double total = 0, sum = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    total += histogram[i];
    sum += static_cast<double>(i) * histogram[i];
  }
  double below = 0, sum_below = 0, best = -1;
  int threshold = 128;
  for (std::size_t i = 0; i + 1 < histogram.size(); ++i) {
    below += histogram[i];
    sum_below += static_cast<double>(i) * histogram[i];
    if (below <= 0 || below >= total) continue;
    const double apart = sum_below / below - (sum - sum_below) / (total - below);
    const double between = below * (total - below) * apart * apart;
    if (between > best) {
      best = between;
      threshold = static_cast<int>(i) + 1;
    }
  }
  return threshold;
}

// Pixel indices of a picture of given size and their neighbors.
class Grid {
 public:
  Grid(int width, int height) : width_(width), height_(height) {}
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  [[nodiscard]] int u(std::size_t i) const { return static_cast<int>(i % static_cast<std::size_t>(width_)); }
  [[nodiscard]] int v(std::size_t i) const { return static_cast<int>(i / static_cast<std::size_t>(width_)); }
  [[nodiscard]] bool at_edge(std::size_t i) const {
    return u(i) == 0 || v(i) == 0 || u(i) == width_ - 1 || v(i) == height_ - 1;
  }
  template <class Visit>
  void neighbors(std::size_t i, bool diagonal, Visit visit) const {
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        const int nu = u(i) + du, nv = v(i) + dv;
        if ((du == 0 && dv == 0) || (!diagonal && du != 0 && dv != 0)) continue;
        if (nu < 0 || nv < 0 || nu >= width_ || nv >= height_) continue;
        visit(static_cast<std::size_t>(nv) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(nu));
      }
    }
  }

 private:
  int width_, height_;
};

// Flood fill: marks `seeds` and all pixels connected to them for which `may` holds in `reached`. Pixels that are
// already marked are not entered.
template <class May>
std::vector<std::size_t> flood(const Grid& grid, std::vector<std::size_t> seeds, bool diagonal, May may,
                               std::vector<std::uint8_t>& reached) {
  for (const std::size_t seed : seeds) reached[seed] = 1;
  for (std::size_t next = 0; next < seeds.size(); ++next) {
    grid.neighbors(seeds[next], diagonal, [&](std::size_t n) {
      if (reached[n] != 0 || !may(n)) return;
      reached[n] = 1;
      seeds.push_back(n);
    });
  }
  return seeds;
}

// Size of the bounding box of the pixels.
std::size_t box_area(const Grid& grid, const std::vector<std::size_t>& pixels) {
  int left = grid.u(pixels[0]), right = left, top = grid.v(pixels[0]), bottom = top;
  for (const std::size_t i : pixels) {
    left = std::min(left, grid.u(i));
    right = std::max(right, grid.u(i));
    top = std::min(top, grid.v(i));
    bottom = std::max(bottom, grid.v(i));
  }
  return static_cast<std::size_t>(right - left + 1) * static_cast<std::size_t>(bottom - top + 1);
}

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
  if (near.size() < kLeastVotes / 2) return line;
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

// Area of the quadrilateral; 0 if sides do not intersect or intersect far outside the picture.
double area_of(const std::array<HoughLine, 4>& sides, int width_px, int height_px) {
  constexpr double kBeyond = 0.1;
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = crossing(sides[kCornerSides[i][0]], sides[kCornerSides[i][1]]);
    const auto outside = [](double at, double size) { return at < -kBeyond * size || at > (1 + kBeyond) * size; };
    if (!corner || outside(corner->x(), width_px) || outside(corner->y(), height_px)) return 0;
    corners[i] = *corner;
  }
  double twice = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

// Pixels inside that touch the region, except specks: a noisy floor as bright as the border is full of them.
std::vector<OutlinePixel> outline_of(const Grid& grid, const std::vector<std::uint8_t>& in_piece,
                                     const std::vector<std::uint8_t>& outside) {
  const auto inside = [&](std::size_t k) { return in_piece[k] == 0 && outside[k] == 0; };
  std::vector<std::uint8_t> visited(grid.size());
  std::vector<OutlinePixel> outline;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (visited[i] != 0 || !inside(i)) continue;
    const std::vector<std::size_t> area = flood(grid, {i}, false, inside, visited);
    if (static_cast<double>(area.size()) < kLeastArea * static_cast<double>(grid.size())) continue;
    for (const std::size_t k : area) {
      bool at_border = false;
      grid.neighbors(k, false, [&](std::size_t n) { at_border = at_border || in_piece[n] != 0; });
      if (at_border) outline.push_back({static_cast<double>(grid.u(k)), static_cast<double>(grid.v(k))});
    }
  }
  return outline;
}

}  // namespace

int brightness_threshold(const hal::Picture& picture) { return otsu(brightness(picture)); }

std::vector<OutlinePixel> border_outline(const hal::Picture& picture, int threshold) {
  const Grid grid(static_cast<int>(picture.width_px), static_cast<int>(picture.height_px));
  const std::vector<std::uint8_t> luma = brightness(picture);
  const auto bright = [&](std::size_t i) { return luma[i] >= threshold; };
  std::vector<std::size_t> rim;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.at_edge(i)) rim.push_back(i);
  }
  std::vector<std::uint8_t> seen(grid.size());
  std::vector<OutlinePixel> best;
  std::size_t most = static_cast<std::size_t>(kLeastEnclosed * static_cast<double>(grid.size()));
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (seen[i] != 0 || !bright(i)) continue;
    const std::vector<std::size_t> piece = flood(grid, {i}, true, bright, seen);
    // Skips specks: a region that encloses less than this cannot be the border.
    if (box_area(grid, piece) <= most) continue;
    std::vector<std::uint8_t> in_piece(grid.size()), outside(grid.size());
    for (const std::size_t k : piece) in_piece[k] = 1;
    const auto is_free = [&](std::size_t k) { return in_piece[k] == 0; };
    std::vector<std::size_t> seeds;
    std::copy_if(rim.begin(), rim.end(), std::back_inserter(seeds), is_free);
    const std::size_t enclosed = grid.size() - piece.size() - flood(grid, seeds, false, is_free, outside).size();
    if (enclosed <= most) continue;
    most = enclosed;
    best = outline_of(grid, in_piece, outside);
  }
  return best;
}

bool hough_sides(const std::vector<OutlinePixel>& outline, int width_px, int height_px,
                 std::array<HoughLine, 4>& sides) {
  const int bend_px = std::max(kUsualBend_px, kUsualBend_px * width_px / kUsualWidth_px);
  const auto diagonal = static_cast<int>(std::ceil(std::hypot(width_px, height_px)));
  const std::size_t distances = std::size_t{2} * static_cast<std::size_t>(diagonal) + 1;
  std::vector<std::uint32_t> votes(kAngles * distances);
  for (int a = 0; a < kAngles; ++a) {
    const double angle = kPi * a / kAngles, c = std::cos(angle), s = std::sin(angle);
    for (const OutlinePixel& p : outline) {
      const auto d = static_cast<std::size_t>(std::lround(p.u_px * c + p.v_px * s) + diagonal);
      ++votes[static_cast<std::size_t>(a) * distances + d];
    }
  }
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const OutlinePixel& p : outline) middle += Eigen::Vector2d(p.u_px, p.v_px) / static_cast<double>(outline.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const OutlinePixel& p : outline) {
    const Eigen::Vector2d away = Eigen::Vector2d(p.u_px, p.v_px) - middle;
    spread += away * away.transpose() / static_cast<double>(outline.size());
  }
  // Finds the best line whose normal is within kSkew_rad of `direction`, on that side of the center and at a distance
  // from it: a center line is as long as a side.
  const auto best = [&](double direction) {
    HoughLine line;
    for (int a = 0; a < kAngles; ++a) {
      double angle = kPi * a / kAngles, turn = std::remainder(angle - direction, 2 * kPi);
      double sign = 1;
      if (std::abs(turn) > kPi / 2) {
        sign = -1;
        turn = std::remainder(angle + kPi - direction, 2 * kPi);
      }
      if (std::abs(turn) > kSkew_rad) continue;
      const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
      const double at_middle = middle.dot(normal), deviation = std::sqrt(normal.dot(spread * normal));
      for (int d = bend_px; d + bend_px < static_cast<int>(distances); ++d) {
        if (sign * (d - diagonal - at_middle) < kLeastDeviations * deviation) continue;
        std::size_t sum = 0;
        for (int k = -bend_px; k <= bend_px; ++k) {
          sum += votes[static_cast<std::size_t>(a) * distances + static_cast<std::size_t>(d + k)];
        }
        if (sum > line.votes) line = {angle, static_cast<double>(d - diagonal), sum};
      }
    }
    return line;
  };
  HoughLine first;
  for (const double direction : {0.0, kPi / 2, kPi, -kPi / 2}) {
    if (const HoughLine line = best(direction); line.votes > first.votes) first = line;
  }
  // Directions down, right, up and left in the picture, rotated like the field.
  const double turn = std::remainder(first.angle_rad, kPi / 2);
  const std::array<double, 4> directions{kPi / 2 + turn, turn, -kPi / 2 + turn, kPi + turn};
  for (std::size_t i = 0; i < 4; ++i) {
    sides[i] = best(directions[i]);
    if (sides[i].votes < kLeastVotes) return false;
  }
  return true;
}

double h_of_three_points(const std::vector<OutlinePixel>& outline, const HoughLine& side, int width_px, int height_px) {
  const Eigen::Vector2d center(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  // Divides the side into ten parts and takes the median offset of the points in each.
  const Eigen::Vector2d along(-std::sin(side.angle_rad), std::cos(side.angle_rad));
  std::vector<std::pair<double, double>> near;  // position along the side, offset
  for (const OutlinePixel& p : outline) {
    const double distance = off(side, p.u_px, p.v_px);
    if (std::abs(distance) < kCollect_px[0]) near.emplace_back(along.dot(Eigen::Vector2d(p.u_px, p.v_px)), distance);
  }
  if (near.size() < kLeastVotes) return kLargestH_px;
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
  // Leaves out the ends, where the adjacent sides begin.
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
  for (const double factor : kThresholds) {
    BorderSearch attempt;
    attempt.threshold = std::clamp(static_cast<int>(std::lround(factor * otsus)), 1, 250);
    attempt.outline = border_outline(picture, attempt.threshold);
    if (attempt.outline.empty()) continue;
    if (!hough_sides(attempt.outline, width, height, attempt.sides)) {
      if (best <= 0) error.text = "the bright region around the field does not have four straight sides";
      continue;
    }
    std::size_t votes = 0;
    for (const HoughLine& side : attempt.sides) votes += side.votes;
    const double share = static_cast<double>(votes) / static_cast<double>(attempt.outline.size());
    const double merit = share * area_of(attempt.sides, width, height);
    if (merit <= best) continue;
    best = merit;
    out = std::move(attempt);
  }
  if (best <= 0) return error;
  // Klancar uses the longest side only, but a goal or a marking at its ends can spoil it. The curvature of eq. (12) is
  // proportional to 1 / H^2 to first order; the second largest is used.
  std::array<double, 4> bend{};
  for (std::size_t i = 0; i < 4; ++i) {
    bend[i] = std::pow(h_of_three_points(out.outline, out.sides[i], width, height), -2);
  }
  std::sort(bend.begin(), bend.end());
  out.h_px = std::sqrt(1 / bend[2]);

  const Eigen::Vector2d center(0.5 * (width - 1), 0.5 * (height - 1));
  std::vector<Eigen::Vector2d> straight;
  for (const OutlinePixel& p : out.outline) straight.push_back(rectified({p.u_px, p.v_px}, center, out.h_px));
  std::array<HoughLine, 4>& lines = out.straight_sides;
  for (std::size_t i = 0; i < 4; ++i) {
    // The middle of the side gives the position of the straightened line; its ends have moved.
    const HoughLine& side = out.sides[i];
    const Eigen::Vector2d normal(std::cos(side.angle_rad), std::sin(side.angle_rad));
    const Eigen::Vector2d nearest = center + (side.distance_px - normal.dot(center)) * normal;
    lines[i] = {side.angle_rad, normal.dot(rectified(nearest, center, out.h_px)), side.votes};
    for (const double within : kCollect_px) lines[i] = refitted(straight, lines[i], within);
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
