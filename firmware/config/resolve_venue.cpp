#include <cmath>
#include <filesystem>

#include "core/color/color_tables.h"
#include "firmware/config/error_list.h"
#include "firmware/config/light_map_file.h"
#include "firmware/config/resolve.h"
#include "firmware/config/wording.h"

namespace touchline::config {
namespace {

std::string_view word_of(PixelFormat format) { return info_of(format).word; }
std::string_view word_of(ColorSpace space) { return kColorSpaceWords[static_cast<std::size_t>(space)].word; }

std::string size_text(unsigned width, unsigned height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

// The entry of the venue file from which a color box comes.
struct BoxSource {
  std::size_t color = 0, box = 0;
};

std::string box_text(const ColorBoxEntry& box) {
  std::string text;
  for (const auto& [name, channel] : {std::pair{"low", &box.low}, std::pair{"high", &box.high}}) {
    text.append(text.empty() ? "" : ", ").append(name).append(" [");
    for (std::size_t i = 0; i < 3; ++i) text.append(i == 0 ? "" : ", ").append(std::to_string((*channel)[i]));
    text += "]";
  }
  return text;
}

void check_overlap(const VenueFile& venue, const Locations& where, const std::vector<BoxSource>& sources,
                   ErrorList& errors) {
  const auto box_of = [&](const BoxSource& source) -> const ColorBoxEntry& {
    return venue.color[source.color].box[source.box];
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (sources[i].color == sources[j].color) continue;
      const ColorBoxEntry &a = box_of(sources[j]), &b = box_of(sources[i]);
      ColorBoxEntry common;
      bool meet = true;
      for (std::size_t c = 0; c < 3; ++c) {
        common.low[c] = std::max(a.low[c], b.low[c]);
        common.high[c] = std::min(a.high[c], b.high[c]);
        meet = meet && common.low[c] <= common.high[c];
      }
      if (!meet) continue;
      const std::string key = element(element("color", sources[i].color) + ".box", sources[i].box);
      const std::string other = element(element("color", sources[j].color) + ".box", sources[j].box);
      errors.add(where.of(key), key,
                 "box of \"" + venue.color[sources[i].color].name + "\" overlaps the box of \"" +
                     venue.color[sources[j].color].name + "\" at " + where.of(other) + " in " + box_text(common));
    }
  }
}

void resolve_colors(const VenueFile& venue, const Locations& where, ColorBoxes& boxes, ErrorList& errors) {
  boxes.clear();
  std::vector<BoxSource> sources;
  if (venue.color.empty()) {
    errors.add(where.file(), "color", "no [[color]]; run touchline-calibrate colors");
  }
  if (venue.color.size() > kMaxColors) {
    errors.add(
        where.of("color"), "color",
        std::to_string(venue.color.size()) + " colors; at most " + std::to_string(kMaxColors) + " are supported");
    return;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < venue.color.size(); ++i) {
    const ColorEntry& color = venue.color[i];
    const std::string path = element("color", i);
    for (std::size_t j = 0; j < i; ++j) {
      if (venue.color[j].name == color.name) {
        errors.add(where.of(path + ".name"), path + ".name",
                   "\"" + color.name + "\" is already defined at " + where.of(element("color", j) + ".name") +
                       "; give the color several [[color.box]] instead");
      }
    }
    if (color.box.empty()) errors.add(where.of(path), path, "\"" + color.name + "\" has no [[color.box]]");
    for (std::size_t j = 0; j < color.box.size(); ++j) {
      const ColorBoxEntry& box = color.box[j];
      const std::string key = element(path + ".box", j);
      ++count;
      bool valid = true;
      for (std::size_t c = 0; c < 3; ++c) {
        if (box.low[c] <= box.high[c]) continue;
        errors.add(where.of(key), key,
                   "low " + std::to_string(box.low[c]) + " is above high " + std::to_string(box.high[c]) +
                       " in channel " + std::to_string(c));
        valid = false;
      }
      if (valid && boxes.push_back({static_cast<ColorId>(i + 1), box.low, box.high})) sources.push_back({i, j});
    }
  }
  if (count > kMaxColorBoxes) {
    errors.add(where.of("color"), "color",
               std::to_string(count) + " boxes; at most " + std::to_string(kMaxColorBoxes) + " are supported");
  }
  check_overlap(venue, where, sources, errors);
}

void resolve_background(const VenueFile& venue, const Locations& where, TypicalBackground& background,
                        ErrorList& errors) {
  const std::vector<std::uint8_t>& value = venue.colors.background;
  background.reset();
  if (value.empty()) return;
  if (value.size() != 3) {
    errors.add(where.of("colors.background"), "colors.background",
               "needs three values, one per channel; has " + std::to_string(value.size()));
    return;
  }
  background = {value[0], value[1], value[2]};
}

void resolve_region_of_interest(const VenueFile& venue, const Locations& where, Polygon& polygon, ErrorList& errors) {
  polygon.clear();
  const RegionOfInterestEntry& region = venue.region_of_interest;
  const std::string key = "region_of_interest";
  if (region.u_px.size() != region.v_px.size()) {
    errors.add(
        where.of(key), key,
        "u_px has " + std::to_string(region.u_px.size()) + " corners, v_px " + std::to_string(region.v_px.size()));
    return;
  }
  if (region.u_px.size() == 1 || region.u_px.size() == 2 || region.u_px.size() > kMaxPolygonPoints) {
    errors.add(
        where.of(key), key,
        "needs 3 to " + std::to_string(kMaxPolygonPoints) + " corners; has " + std::to_string(region.u_px.size()));
    return;
  }
  for (std::size_t i = 0; i < region.u_px.size(); ++i) polygon.push_back({region.u_px[i], region.v_px[i]});
  const std::optional<CrossingSides> crossing = crossing_sides(polygon);
  if (!crossing) return;
  const auto side = [&](std::size_t corner) {
    return std::to_string(corner + 1) + " to " + std::to_string((corner + 1) % polygon.size() + 1);
  };
  errors.add(where.of(key), key,
             "the sides from corner " + side(crossing->first) + " and from corner " + side(crossing->second) +
                 " cross or touch; give the corners in their order around the region");
}

// Fills the limits of the adaptation and the typical values of the colors. The adaptation changes the light map, so it
// starts with a uniform one if the venue file has none.
void resolve_adaptation(const VenueFile& venue, const Locations& where, PipelineParameters& out, ErrorList& errors) {
  out.adaptation = venue.adaptation;
  for (std::size_t i = 0; i < venue.color.size() && i < kMaxColors; ++i) {
    const ColorEntry& color = venue.color[i];
    const std::string key = element("color", i) + ".typical";
    if (!color.typical.empty() && color.typical.size() != 3) {
      errors.add(where.of(key), key,
                 "needs three values, one per channel; has " + std::to_string(color.typical.size()));
      continue;
    }
    out.adaptation.typical.measured[i + 1] = !color.typical.empty();
    for (std::size_t c = 0; c < 3 && !color.box.empty(); ++c) {
      const ColorBoxEntry& box = color.box[0];
      out.adaptation.typical[i + 1][c] =
          color.typical.empty() ? static_cast<std::uint8_t>((box.low[c] + box.high[c]) / 2) : color.typical[c];
    }
  }
  out.scan.box_shift_limit = 0;
  if (venue.adaptation.mode == AdaptationMode::kOff) return;
  out.scan.box_shift_limit = static_cast<std::uint8_t>(std::ceil(venue.adaptation.max_shift));
  if (out.scan.light.columns > 0) return;
  out.scan.light.columns = out.scan.light.rows = 1;
  for (auto& plane : out.scan.light.illumination) plane[0] = 1.0f;
}

}  // namespace

ColorId color_id(const VenueFile& venue, std::string_view name) {
  for (std::size_t i = 0; i < venue.color.size() && i < kMaxColors; ++i) {
    if (venue.color[i].name == name) return static_cast<ColorId>(i + 1);
  }
  return kBackground;
}

Result<void> resolve_venue(const VenueFile& venue, const Locations& where, const InputFormat& input,
                           PipelineParameters& out) {
  ErrorList errors;
  out.scan.format = input.format;
  out.scan.width_px = input.width_px;
  out.scan.height_px = input.height_px;
  out.scan.min_area_px = venue.picture.min_area_px;
  out.scan.min_height_px = venue.picture.min_height_px;
  if (venue.picture.width_px != input.width_px || venue.picture.height_px != input.height_px) {
    errors.add(where.of("picture.width_px"), "picture",
               "the calibration is for pictures of " + size_text(venue.picture.width_px, venue.picture.height_px) +
                   " pixels, but " + input.source + " delivers " + size_text(input.width_px, input.height_px));
  }
  if (venue.colors.space != color_space(input.format)) {
    const std::string format(input.word.empty() ? word_of(input.format) : input.word);
    errors.add(where.of("colors.space"), "colors.space",
               "the boxes are in " + std::string(word_of(venue.colors.space)) + ", but " + input.source + " delivers " +
                   format + ", which is " + std::string(word_of(color_space(input.format))) +
                   "; calibrate the colors again: touchline-calibrate colors --format " + format);
  }
  resolve_colors(venue, where, out.scan.boxes, errors);
  resolve_background(venue, where, out.scan.background, errors);
  resolve_region_of_interest(venue, where, out.scan.region_of_interest, errors);

  out.scan.light.columns = out.scan.light.rows = 0;
  if (!venue.light.map.empty()) {
    const auto path = std::filesystem::path(where.file()).parent_path() / venue.light.map;
    const Result<void> read = read_light_map(path.string(), out.scan.light);
    if (!read.ok()) errors.add(where.of("light.map"), "light.map", read.text());
  }

  resolve_adaptation(venue, where, out, errors);
  // Skip pictures of another size, which were reported above.
  const bool same_size = venue.picture.width_px == input.width_px && venue.picture.height_px == input.height_px;
  if (!venue.light.reference.empty() && same_size) {
    const auto path = std::filesystem::path(where.file()).parent_path() / venue.light.reference;
    const Result<void> read =
        read_light_reference(path.string(), input.width_px, input.height_px, out.adaptation.reference);
    if (!read.ok()) errors.add(where.of("light.reference"), "light.reference", read.text());
  }

  out.camera = venue.camera_model;
  const std::string kind = venue.camera_model.kind == CameraModelKind::kFull ? "full" : "paper";
  if (where.has("camera_model.kind") && !where.has("camera_model." + kind)) {
    errors.add(where.of("camera_model.kind"), "camera_model." + kind, "is missing; run touchline-calibrate field");
  }
  out.marker.field = venue.field;
  return errors.result();
}

}  // namespace touchline::config
