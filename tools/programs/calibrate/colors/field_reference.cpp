#include "tools/programs/calibrate/colors/field_reference.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "core/geometry/camera_model.h"
#include "core/region/region_of_interest.h"
#include "firmware/config/light_map_file.h"
#include "firmware/config/light_writer.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Distance from the edge of a patch to the edge of its robot; the largest robots (SSL) have a radius of 9 cm.
constexpr float kRobot_m = 0.1f;
constexpr float kRobotWithoutModel_px = 24.0f;
constexpr float kOutside_m = 0.25f;
// Smaller regions are noise; larger ones (by share of the picture's width or height) are floor or furniture.
constexpr std::uint32_t kMinArea_px = 8;
constexpr unsigned kLargest_share = 4;

class Coverage {
 public:
  Coverage(const VenueDraft& draft, const Frame& frame) : grid_(ReferenceGrid::of(frame.width_px, frame.height_px)) {
    CameraModel camera;
    if (has_camera_model(draft) && camera.configure(draft.file.camera_model).ok()) camera_ = camera;
    const auto roi = std::make_unique<RegionOfInterest>();
    const bool has_roi = roi->build(draft.region_of_interest, frame.width_px, frame.height_px).ok();
    const float x = draft.file.field.length_m / 2 + kOutside_m, y = draft.file.field.width_m / 2 + kOutside_m;
    for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
      const PixelPoint center = center_of(cell);
      if (camera_) {
        const FieldPoint at = camera_->to_field(center, 0.0f);
        near_field_.push_back(std::abs(at.x_m) < x && std::abs(at.y_m) < y);
      } else {
        near_field_.push_back(!has_roi || in_region(*roi, center, frame));
      }
    }
  }

  void begin() { covered_.assign(grid_.cells(), false); }
  void cover(PixelPoint low, PixelPoint high) {
    const float margin =
        robot_px({(low.u_px + high.u_px) / 2, (low.v_px + high.v_px) / 2}) + static_cast<float>(grid_.side_px) / 2;
    for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
      const PixelPoint at = center_of(cell);
      if (at.u_px > low.u_px - margin && at.u_px < high.u_px + margin && at.v_px > low.v_px - margin &&
          at.v_px < high.v_px + margin) {
        covered_[cell] = true;
      }
    }
  }
  [[nodiscard]] bool usable(std::size_t cell) const { return near_field_[cell] && !covered_[cell]; }
  [[nodiscard]] const ReferenceGrid& grid() const { return grid_; }

 private:
  [[nodiscard]] PixelPoint center_of(std::size_t cell) const {
    const float side = grid_.side_px;
    const std::size_t row = cell / grid_.columns, column = cell % grid_.columns;
    return {(static_cast<float>(column) + 0.5f) * side, (static_cast<float>(row) + 0.5f) * side};
  }
  static bool in_region(const RegionOfInterest& region, PixelPoint center, const Frame& frame) {
    const auto v = static_cast<std::uint16_t>(std::min(center.v_px, static_cast<float>(frame.height_px - 1)));
    const auto spans = region.row(v);
    return std::any_of(spans.begin(), spans.end(), [&](const ColumnSpan& span) {
      return center.u_px >= static_cast<float>(span.begin) && center.u_px < static_cast<float>(span.end);
    });
  }
  [[nodiscard]] float robot_px(PixelPoint at) const {
    if (!camera_) return kRobotWithoutModel_px;
    const FieldPoint here = camera_->to_field(at, 0.0f);
    const PixelPoint beside = camera_->to_pixel({here.x_m + kRobot_m, here.y_m}, 0.0f);
    return std::hypot(beside.u_px - at.u_px, beside.v_px - at.v_px);
  }

  ReferenceGrid grid_;
  std::optional<CameraModel> camera_;
  std::vector<bool> near_field_, covered_;
};

// The cells of a picture that show the field: R, G, B.
using FieldCells = std::vector<std::optional<std::array<std::uint16_t, 3>>>;

double brightness_of(const FieldCells& field) {
  std::vector<double> sums;
  for (const auto& cell : field) {
    if (cell) sums.push_back(static_cast<double>((*cell)[0] + (*cell)[1] + (*cell)[2]));
  }
  return sums.empty() ? 0.0 : statistics::median(sums);
}

// Returns whether both pictures were taken in the same light: most cells that both show differ little in each channel.
bool has_light_of(const FieldCells& field, const FieldCells& other) {
  constexpr double kMaxChange = 0.1;  // logarithm of the ratio of two cells
  constexpr double kDark = 2.0;       // sum of a cell that is hardly more than noise
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> ratios;
    for (std::size_t cell = 0; cell < field.size(); ++cell) {
      if (!field[cell] || !other[cell]) continue;
      ratios.push_back(((*field[cell])[c] + kDark) / ((*other[cell])[c] + kDark));
    }
    if (!ratios.empty() && std::abs(std::log(statistics::median(ratios))) > kMaxChange) return false;
  }
  return true;
}

struct ColoredRegions {
  RegionScanner scanner;
  Runs runs;
  Regions regions;
};

// Marks as covered everything that has a color of a robot or of the ball.
void cover_colors(const ColorFitInput& input, const ColorFit& fit, const Frame& frame, ColoredRegions& scan,
                  Coverage& coverage) {
  ScanParameters parameters;
  parameters.format = frame.format;
  parameters.width_px = frame.width_px;
  parameters.height_px = frame.height_px;
  parameters.boxes = fit.learned.boxes;
  parameters.light = input.light;
  parameters.region_of_interest = input.region_of_interest;
  if (!scan.scanner.configure(parameters).ok()) return;
  (void)scan.scanner.scan(frame, scan.runs, scan.regions);  // regions that do not fit are only small noise
  for (const Region& region : scan.regions) {
    const PixelBox& box = region.box;
    if (region.area_px < kMinArea_px || kLargest_share * (box.right - box.left) > frame.width_px ||
        kLargest_share * (box.bottom - box.top) > frame.height_px) {
      continue;
    }
    coverage.cover({static_cast<float>(box.left), static_cast<float>(box.top)},
                   {static_cast<float>(box.right), static_cast<float>(box.bottom)});
  }
}

// Returns the field in the pictures that have the same light as the picture with most patches, because the typical
// colors come from its light. If several pictures have most patches, the one with the median brightness is used. Cells
// from pictures under two lamps must not be mixed, because the result would fit neither.
std::vector<FieldCells> fields_in_one_light(const VenueDraft& draft, const ColorFitInput& input, const ColorFit& fit) {
  Coverage coverage(draft, input.pictures.begin()->second.frame());
  const ReferenceGrid grid = coverage.grid();
  const auto scan = std::make_unique<ColoredRegions>();
  const auto colors = std::make_unique<CellColors>();
  std::vector<FieldCells> fields;
  std::vector<std::pair<std::ptrdiff_t, double>> order;  // number of patches (most first), then brightness
  for (const auto& [name, picture] : input.pictures) {
    if (!input.learns_from(name)) continue;
    const Frame frame = picture.frame();
    coverage.begin();
    cover_colors(input, fit, frame, *scan, coverage);
    std::ptrdiff_t patches = 0;
    for (const Click& click : input.clicks) {
      if (click.image != name) continue;
      const PixelPoint at{static_cast<float>(click.u_px), static_cast<float>(click.v_px)};
      coverage.cover(at, at);
      ++patches;
    }
    for (std::size_t row = 0; row < grid.rows; ++row) sample_cells(frame, grid, row, *colors);
    FieldCells field(grid.cells());
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
      if (!coverage.usable(cell)) continue;
      field[cell] = std::array{colors->sum[0][cell], colors->sum[1][cell], colors->sum[2][cell]};
    }
    order.emplace_back(-patches, brightness_of(field));
    fields.push_back(std::move(field));
  }
  std::vector<std::pair<std::ptrdiff_t, double>> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  const auto most =
      std::count_if(sorted.begin(), sorted.end(), [&](const auto& one) { return one.first == sorted.front().first; });
  const auto usual = std::find(order.begin(), order.end(), sorted[static_cast<std::size_t>(most - 1) / 2]);
  const FieldCells light = fields[static_cast<std::size_t>(usual - order.begin())];
  std::vector<FieldCells> out;
  std::copy_if(fields.begin(), fields.end(), std::back_inserter(out),
               [&](const FieldCells& field) { return has_light_of(field, light); });
  return out;
}

}  // namespace

LightReference field_reference(const VenueDraft& draft, const ColorFitInput& input, const ColorFit& fit) {
  LightReference out;
  if (input.pictures.empty()) return out;
  const std::vector<FieldCells> fields = fields_in_one_light(draft, input, fit);
  const Frame first = input.pictures.begin()->second.frame();
  const ReferenceGrid grid = ReferenceGrid::of(first.width_px, first.height_px);
  out.columns = grid.columns;
  out.rows = grid.rows;
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<std::uint16_t> all;
      for (const FieldCells& field : fields) {
        if (field[cell]) all.push_back((*field[cell])[c]);
      }
      if (all.empty()) continue;
      const auto middle = all.begin() + static_cast<std::ptrdiff_t>((all.size() - 1) / 2);
      std::nth_element(all.begin(), middle, all.end());
      out.colors.sum[c][cell] = *middle;
    }
  }
  return out;
}

Result<Section> write_field_reference(const std::string& venue, const VenueDraft& draft, const ColorFitInput& input,
                                      const ColorFit& fit) {
  const auto reference = std::make_unique<LightReference>(field_reference(draft, input, fit));
  Result<std::string> png = config::encode_light_reference(*reference);
  if (!png.ok()) return prefixed(venue, std::move(png).error());
  config::LightEntry light = draft.file.light;
  TOUCHLINE_TRY_ASSIGN(light.reference,
                       config::write_venue_picture(venue, "field", draft.file.light.reference, png.value()));
  return section_of("light", light, "");
}

}  // namespace touchline::calibrate
