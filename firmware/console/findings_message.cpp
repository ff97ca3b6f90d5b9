#include "firmware/console/findings_message.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/color_space.h"
#include "firmware/config/uncalibrated.h"
#include "firmware/report/trace_json.h"

namespace touchline::console {
namespace {

using report::JsonWriter;
using report::kMeterStep;
using report::write_number;

void write_integers(JsonWriter& json, std::string_view key, const std::array<std::uint8_t, 3>& values) {
  json.key(key);
  json.begin_array();
  for (const std::uint8_t value : values) json.integer(value);
  json.end_array();
}

void write_floor(JsonWriter& json, const Scene& scene, PixelPoint pixel) {
  json.key("floor");
  if (!scene.is_calibrated && !config::has_camera_model(*scene.configuration)) return json.null();
  const FieldPoint place = scene.model.to_field(pixel, 0.0f);
  json.begin_object();
  write_number(json, "x_m", place.x_m, kMeterStep);
  write_number(json, "y_m", place.y_m, kMeterStep);
  json.end_object();
}

bool has(const PixelBox& box, std::uint16_t u, std::uint16_t v) {
  return u >= box.left && u <= box.right && v >= box.top && v <= box.bottom;
}

// Writes the smallest region of the pixel's color whose box contains the pixel; the box is used because runs are not
// copied.
void write_region_at(JsonWriter& json, const PictureFindings& findings, std::uint16_t u, std::uint16_t v,
                     ColorId color) {
  json.key("region");
  const Region* found = nullptr;
  for (const Region& region : findings.regions) {
    if (region.color != color || !has(region.box, u, v)) continue;
    if (found == nullptr || region.area_px < found->area_px) found = &region;
  }
  if (color == kBackground || found == nullptr) return json.null();
  const Verdict verdict = findings.verdicts[static_cast<std::size_t>(found - findings.regions.begin())];
  json.begin_object();
  json.key("area_px");
  json.integer(found->area_px);
  json.key("verdict");
  json.string(describe(verdict));
  json.end_object();
}

}  // namespace

void RunLengthWriter::add(std::uint8_t value) {
  if (count_ > 0 && (value != value_ || count_ == std::numeric_limits<std::uint16_t>::max())) end();
  value_ = value;
  ++count_;
}

void RunLengthWriter::end() {
  if (count_ == 0) return;
  for (const int byte : {count_ & 0xFF, count_ >> 8, int{value_}}) out_.push_back(static_cast<std::byte>(byte));
  count_ = 0;
}

void append_classes(const Frame& frame, const PixelClassifier& classifier, int divisor, std::vector<std::byte>& out) {
  RunLengthWriter runs(out);
  const int width = frame.width_px / divisor, height = frame.height_px / divisor;
  for (int row = 0; row < height; ++row) {
    const auto v = static_cast<std::uint16_t>(row * divisor + divisor / 2);
    for (int column = 0; column < width; ++column) {
      const auto u = static_cast<std::uint16_t>(column * divisor + divisor / 2);
      runs.add(classifier.is_inside(u, v) ? classifier.color_at(frame, u, v) : kOutsideClass);
    }
  }
  runs.end();
}

void append_light(const PixelClassifier& classifier, std::vector<std::byte>& out) {
  RunLengthWriter runs(out);
  const std::size_t columns = std::max<std::size_t>(classifier.tile_columns(), 1);
  const std::size_t tiles = columns * std::max<std::size_t>(classifier.tile_rows(), 1);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const std::array<std::uint8_t, 3> level = classifier.levels_of_tile(tile % columns, tile / columns);
    runs.add(static_cast<std::uint8_t>((level[0] + level[1] + level[2] + 1) / 3));
  }
  runs.end();
}

void write_regions(JsonWriter& json, const PictureFindings& findings, std::uint64_t number) {
  std::vector<std::size_t> shown(findings.regions.size());
  std::iota(shown.begin(), shown.end(), std::size_t{0});
  const std::size_t left_out = shown.size() - std::min(shown.size(), kMaxShownRegions);
  if (left_out > 0) {
    const auto before = [&](std::size_t a, std::size_t b) {
      const bool examined_a = findings.verdicts[a] != Verdict::kNotExamined;
      const bool examined_b = findings.verdicts[b] != Verdict::kNotExamined;
      if (examined_a != examined_b) return examined_a;
      return findings.regions[a].area_px > findings.regions[b].area_px;
    };
    std::nth_element(shown.begin(), shown.begin() + kMaxShownRegions, shown.end(), before);
    shown.resize(kMaxShownRegions);
  }
  json.begin_object();
  json.key("type");
  json.string("regions");
  json.key("number");
  json.integer(static_cast<std::int64_t>(number));
  json.key("regions");
  json.begin_array();
  for (const std::size_t i : shown) {
    const Region& region = findings.regions[i];
    json.begin_array();
    for (const std::uint16_t edge : {region.box.left, region.box.top, region.box.right, region.box.bottom}) {
      json.integer(edge);
    }
    json.integer(region.color);
    json.integer(region.area_px);
    json.integer(static_cast<std::int64_t>(findings.verdicts[i]));
    json.end_array();
  }
  json.end_array();
  json.key("left_out");
  json.integer(static_cast<std::int64_t>(left_out));
  json.end_object();
}

void write_probe(JsonWriter& json, const Scene& scene, const Frame& frame, const PictureFindings& findings,
                 PixelPoint pixel, std::uint64_t number, std::int64_t to) {
  const auto u = static_cast<std::uint16_t>(std::lround(pixel.u_px));
  const auto v = static_cast<std::uint16_t>(std::lround(pixel.v_px));
  const PixelClassifier& classifier = findings.classifier;
  const std::array<std::uint8_t, 3> value = pixel_at(frame, u, v);
  const ColorSpace space = color_space(frame.format);
  json.begin_object();
  json.key("type");
  json.string("answer");
  json.key("to");
  json.integer(to);
  json.key("ok");
  json.boolean(true);
  json.key("result");
  json.begin_object();
  json.key("number");
  json.integer(static_cast<std::int64_t>(number));
  json.key("u_px");
  json.integer(u);
  json.key("v_px");
  json.integer(v);
  json.key("space");
  json.string(is_yuv(space) ? "yuv" : "rgb");
  write_integers(json, "value", value);
  write_integers(json, "rgb", to_rgb8(value, space));
  const bool is_inside = classifier.is_inside(u, v);
  const ColorId color = is_inside ? classifier.color_at(frame, u, v) : kBackground;
  json.key("class");
  json.integer(is_inside ? color : kOutsideClass);
  write_integers(json, "light", classifier.levels_of_tile(u / kTileWidth, v / kTileHeight));
  write_floor(json, scene, pixel);
  write_region_at(json, findings, u, v, color);
  json.end_object();
  json.end_object();
}

}  // namespace touchline::console
