#include "tools/programs/calibrate/colors/color_fit.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tools/programs/calibrate/colors/initial_boxes.h"
#include "tools/programs/calibrate/colors/patch_extent.h"
#include "tools/programs/calibrate/colors/patch_selection.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Width of the margin around a patch. Its pixels belong neither to the patch nor to the background: Bayer interpolation
// and chroma subsampling reach two pixels.
constexpr int kEdge_px = 3;

// Share of a patch's pixels that is cut off at each end of each channel, because these pixels are mixed with the
// surroundings.
constexpr double kEdgeShare = 0.03;

// Least distance of two colors in levels: twice the change that lamp flicker and a tilted robot cause.
constexpr int kMinPairMargin = 20;

// Number of patches of a color that suffices to show the light on the field. Then a team color needs no boxes for other
// light, in which mixed pixels of edges could join patches; the same holds for the ball.
constexpr int kManyPatches = 15;

// Reasons why a pixel is not background; a later one overrides an earlier one.
enum Reserved : std::uint8_t { kFree, kLookAlike, kNearClick };

// A picture during color learning.
struct Scene {
  std::string image;
  const CameraPicture* picture = nullptr;
  ChannelImage channels;
  std::vector<std::uint8_t> owner;     // for each pixel, index of its color + 1; 0: none
  std::vector<std::uint8_t> reserved;  // one Reserved value per pixel
};

void reserve_around(Scene& scene, int u, int v, Reserved why) {
  for (int dv = -kEdge_px; dv <= kEdge_px; ++dv) {
    for (int du = -kEdge_px; du <= kEdge_px; ++du) {
      if (!scene.channels.contains(u + du, v + dv)) continue;
      std::uint8_t& reserved = scene.reserved[scene.channels.index(u + du, v + dv)];
      reserved = std::max<std::uint8_t>(reserved, why);
    }
  }
}

void reserve_pixel(Scene& scene, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(scene.channels.width_px);
  reserve_around(scene, static_cast<int>(pixel % width), static_cast<int>(pixel / width), kNearClick);
}

// On the heap, because buffers of the scanner are large.
struct Scan {
  RegionScanner scanner;
  Runs runs;
  Regions regions;
};

Status scan(const ColorFitInput& input, const ColorBoxes& boxes, const CameraPicture& picture, Scan& out) {
  const Frame frame = picture.frame();
  ScanParameters parameters;
  parameters.format = frame.format;
  parameters.width_px = frame.width_px;
  parameters.height_px = frame.height_px;
  parameters.boxes = boxes;
  parameters.light = input.light;
  parameters.region_of_interest = input.region_of_interest;
  if (Status s = out.scanner.configure(parameters); !s.ok()) return s;
  const Status s = out.scanner.scan(frame, out.runs, out.regions);
  return s.code() == ErrorCode::kFull ? Status{} : s;  // regions that do not fit are only small noise
}

template <class Visit>
void each_pixel(const Runs& runs, const Region& region, Visit&& visit) {
  for (std::uint32_t i = region.first_run; i != kNoRun; i = runs[i].next) {
    for (int u = runs[i].begin; u < runs[i].end; ++u) visit(u, static_cast<int>(runs[i].row));
  }
}

// Returns the median of each channel.
Channels median(const std::vector<ColorCount>& pixels) {
  return {quantile(pixels, 0, 0.5), quantile(pixels, 1, 0.5), quantile(pixels, 2, 0.5)};
}

bool touches_click(const Scene& scene, const Runs& runs, const Region& region) {
  bool touched = false;
  each_pixel(runs, region, [&](int u, int v) { touched |= scene.reserved[scene.channels.index(u, v)] == kNearClick; });
  return touched;
}

class Fitter {
 public:
  explicit Fitter(const ColorFitInput& input) : input_(input), scan_(std::make_unique<Scan>()) {}

  Result<ColorFit> run() {
    TOUCHLINE_TRY(read_scenes());
    TOUCHLINE_TRY(grow_clicks());
    LearningInput learning = samples();
    // Finds similar regions first: a patch without a click would push the boxes away from its own color.
    TOUCHLINE_TRY(reserve_look_alikes(learning));
    learning.background = background();
    learning.things = things();
    learning.brightest = brightest();
    if (!learning.background.empty()) out_.background = median(learning.background);
    TOUCHLINE_TRY_ASSIGN(out_.learned, learn_boxes(learning, input_.rules));
    out_.advice = advise(learning, input_.rules, out_.shown_rgb, out_.learned.margins, kMinPairMargin);
    TOUCHLINE_TRY(judge());
    return std::move(out_);
  }

 private:
  Result<void> read_scenes() {
    if (input_.pictures.empty()) {
      return Error{ErrorCode::kNotFound, "there is no picture"};
    }
    const Frame first = input_.pictures.begin()->second.frame();
    out_.space = color_space(first.format);
    auto shading = std::make_unique<Shading>();
    if (input_.light.columns > 0) {
      if (Status s = shading->build(input_.light, first.width_px, first.height_px, out_.space); !s.ok()) {
        return failure(s.code(), "the light map does not fit the pictures: %s", describe(s.code()));
      }
    }
    inside_ = inside_mask(input_.region_of_interest, first.width_px, first.height_px);
    for (const auto& [image, picture] : input_.pictures) {
      const Frame frame = picture.frame();
      if (frame.format != first.format || frame.width_px != first.width_px || frame.height_px != first.height_px) {
        return failure(ErrorCode::kInconsistent,
                       "%s is %u x %u, %s is %u x %u: all pictures must have the size of the camera's frames",
                       image.c_str(), frame.width_px, frame.height_px, input_.pictures.begin()->first.c_str(),
                       first.width_px, first.height_px);
      }
      if (!input_.learns_from(image)) continue;
      Scene scene{image, &picture, corrected_channels(frame, *shading), {}, {}};
      scene.owner.assign(scene.channels.pixels.size(), 0);
      scene.reserved.assign(scene.channels.pixels.size(), kFree);
      scenes_.push_back(std::move(scene));
    }
    return {};
  }

  Result<void> grow_clicks() {
    for (const Click& click : input_.clicks) {
      auto name = std::find(out_.names.begin(), out_.names.end(), click.color);
      if (name == out_.names.end()) name = out_.names.insert(out_.names.end(), click.color);
      const auto color = static_cast<std::size_t>(name - out_.names.begin());
      const auto scene =
          std::find_if(scenes_.begin(), scenes_.end(), [&](const Scene& s) { return s.image == click.image; });
      ClickResult result;
      GrownPatch patch;
      if (scene == scenes_.end()) {
        result.reason = "the picture is missing";
      } else if (Result<GrownPatch> selected = select_patch(scene->channels, inside_, click, input_.growth);
                 selected.ok()) {
        patch = std::move(selected).value();
        result.area_px = patch.pixels.size();
        for (const std::size_t pixel : patch.pixels) {
          if (click.usual.empty()) scene->owner[pixel] = static_cast<std::uint8_t>(color + 1);
          reserve_pixel(*scene, pixel);
        }
        // Pixels that continue a patch have its color. If they counted as background, the boxes would shrink to the
        // noise of the samples.
        for (const std::size_t pixel : continue_patch(scene->channels, inside_, patch.pixels))
          reserve_pixel(*scene, pixel);
      } else {
        result.reason = selected.text();
        if (scene->channels.contains(static_cast<int>(click.u_px), static_cast<int>(click.v_px))) {
          // There is an object here, although its outline is unclear.
          reserve_around(*scene, static_cast<int>(click.u_px), static_cast<int>(click.v_px), kNearClick);
        }
      }
      patches_.push_back(
          {scene == scenes_.end() ? 0 : static_cast<std::size_t>(scene - scenes_.begin()), color, std::move(patch)});
      out_.clicks.push_back(std::move(result));
    }
    for (Scene& scene : scenes_) {
      const auto unclear = input_.unclear.find(scene.image);
      if (unclear == input_.unclear.end()) continue;
      for (const std::size_t pixel : unclear->second) reserve_pixel(scene, pixel);
    }
    patch_area_.assign(out_.names.size(), 0);
    for (std::size_t c = 0; c < out_.names.size(); ++c) {
      std::vector<std::size_t> areas;
      for (const Grown& g : patches_) {
        if (g.color == c && !g.patch.pixels.empty()) areas.push_back(g.patch.pixels.size());
      }
      if (!areas.empty()) patch_area_[c] = statistics::median(areas);
    }
    for (std::size_t c = 0; c < patch_area_.size(); ++c) {
      if (patch_area_[c] == 0) {
        std::string text = "color " + out_.names[c] + ": no click selected a patch";
        for (std::size_t i = 0; i < patches_.size(); ++i) {
          if (patches_[i].color == c) text += " (" + out_.clicks[i].reason + ")";
        }
        return Error{ErrorCode::kNotFound, text};
      }
    }
    return {};
  }

  [[nodiscard]] ColorUse use_of(std::size_t color) const {
    const auto use = input_.uses.find(out_.names[color]);
    if (use == input_.uses.end()) return ColorUse::kOther;
    const auto has_many = [this](std::size_t other) {
      const auto count = std::count_if(patches_.begin(), patches_.end(),
                                       [&](const Grown& g) { return g.color == other && !g.patch.pixels.empty(); });
      return count >= kManyPatches;
    };
    bool is_light_shown = use->second == ColorUse::kTeam && has_many(color);
    for (std::size_t other = 0; use->second == ColorUse::kBall && other < out_.names.size(); ++other)
      is_light_shown = is_light_shown || has_many(other);
    return is_light_shown ? ColorUse::kOther : use->second;
  }

  LearningInput samples() {
    std::vector<std::vector<Channels>> pixels(out_.names.size());
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      const Grown& g = patches_[i];
      // The edge is cut off per patch, so that a patch in poor light counts as much as ten in good light.
      std::vector<Channels> own = input_.clicks[i].usual;
      if (own.empty()) {
        for (const std::size_t pixel : g.patch.pixels) own.push_back(scenes_[g.scene].channels.pixels[pixel]);
      }
      if (own.empty()) continue;
      const ColorBox inner = core_of(count_colors(own), static_cast<ColorId>(g.color + 1), kEdgeShare);
      std::copy_if(own.begin(), own.end(), std::back_inserter(pixels[g.color]),
                   [&](const Channels& p) { return contains(inner, p); });
    }
    LearningInput learning;
    learning.space = out_.space;
    for (std::size_t c = 0; c < pixels.size(); ++c) {
      learning.colors.push_back({out_.names[c], count_colors(pixels[c]), use_of(c)});
      out_.typical.push_back(median(learning.colors.back().pixels));
      out_.shown_rgb.push_back(to_rgb8(out_.typical.back(), out_.space));
    }
    return learning;
  }

  Result<void> reserve_look_alikes(LearningInput learning) {
    LearningRules rules = input_.rules;
    // Noise between two patches of a color, in levels.
    rules.max_margin = 6;
    // Boxes for other light are not needed here.
    for (ColorSamples& color : learning.colors) color.use = ColorUse::kOther;
    TOUCHLINE_TRY_ASSIGN(const LearnedColors cores, learn_boxes(learning, rules));
    for (Scene& scene : scenes_) {
      if (Status s = scan(input_, cores.boxes, *scene.picture, *scan_); !s.ok()) return scan_error(s);
      for (const Region& region : scan_->regions) {
        if (!is_look_alike(region) || touches_click(scene, scan_->runs, region)) continue;
        each_pixel(scan_->runs, region, [&](int u, int v) { reserve_around(scene, u, v, kLookAlike); });
      }
    }
    return {};
  }

  // Returns whether the matcher could take a region for a patch.
  [[nodiscard]] bool is_patch_sized(const Region& region) const {
    return region.color != kBackground && std::size_t{2} * region.area_px >= patch_area_[region.color - 1U];
  }
  // Larger regions are floor or furniture.
  [[nodiscard]] bool is_look_alike(const Region& region) const {
    return is_patch_sized(region) && region.area_px <= 2 * patch_area_[region.color - 1U];
  }

  [[nodiscard]] std::vector<ColorCount> things() const {
    std::vector<Channels> pixels;
    for (const Scene& scene : scenes_) {
      const auto found = input_.things.find(scene.image);
      if (found == input_.things.end()) continue;
      for (const std::size_t pixel : found->second) pixels.push_back(scene.channels.pixels[pixel]);
    }
    return count_colors(pixels);
  }

  // Returns the brightest value in the pictures, ignoring a few pixels that are reflections of lamps or noise.
  [[nodiscard]] int brightest() const {
    constexpr double kShare = 0.999;
    std::vector<std::uint8_t> values;
    for (const Scene& scene : scenes_) {
      for (std::size_t i = 0; i < scene.channels.pixels.size(); ++i) {
        if (inside_[i] == 0) continue;
        const Channels rgb = to_rgb8(scene.channels.pixels[i], out_.space);
        values.push_back(*std::max_element(rgb.begin(), rgb.end()));
      }
    }
    if (values.empty()) return 255;
    const auto top = values.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(values.size()));
    std::nth_element(values.begin(), top, values.end());
    return *top;
  }

  std::vector<ColorCount> background() const {
    std::vector<Channels> pixels;
    for (const Scene& scene : scenes_) {
      for (std::size_t i = 0; i < scene.channels.pixels.size(); ++i) {
        if (inside_[i] != 0 && scene.reserved[i] == kFree) pixels.push_back(scene.channels.pixels[i]);
      }
    }
    return count_colors(pixels);
  }

  // Classifies each picture like the firmware and measures the result.
  Result<void> judge() {
    const std::size_t colors = out_.names.size();
    std::vector<double> clicked(colors), caught(colors);
    double background = 0;
    out_.confusion.assign(colors, std::vector<double>(colors + 1, 0.0));
    for (std::size_t s = 0; s < scenes_.size(); ++s) {
      Scene& scene = scenes_[s];
      if (Status status = scan(input_, out_.learned.boxes, *scene.picture, *scan_); !status.ok())
        return scan_error(status);
      std::vector<std::uint8_t> classified(scene.channels.pixels.size(), 0);
      for (const Region& region : scan_->regions) {
        each_pixel(scan_->runs, region, [&](int u, int v) { classified[scene.channels.index(u, v)] = region.color; });
        if (is_patch_sized(region) && !touches_click(scene, scan_->runs, region)) {
          out_.strays.push_back({scene.image, region.color - std::size_t{1}, region.centroid, region.area_px});
        }
      }
      for (std::size_t i = 0; i < classified.size(); ++i) {
        if (scene.owner[i] != 0) {
          out_.confusion[scene.owner[i] - 1U][classified[i]] += 1;
          clicked[scene.owner[i] - 1U] += 1;
        } else if (inside_[i] != 0 && scene.reserved[i] == kFree) {
          background += 1;
          if (classified[i] != kBackground) caught[classified[i] - 1U] += 1;
        }
      }
      for (std::size_t i = 0; i < patches_.size(); ++i) {
        const Grown& g = patches_[i];
        if (g.scene != s || g.patch.pixels.empty()) continue;
        const auto right = std::count_if(g.patch.pixels.begin(), g.patch.pixels.end(),
                                         [&](std::size_t pixel) { return classified[pixel] == g.color + 1; });
        out_.clicks[i].recognized = static_cast<double>(right) / static_cast<double>(g.patch.pixels.size());
      }
    }
    for (std::size_t c = 0; c < colors; ++c) {
      for (double& share : out_.confusion[c]) share /= std::max(1.0, clicked[c]);
      out_.background_share.push_back(caught[c] / std::max(1.0, background));
    }
    return {};
  }

  static Error scan_error(Status status) {
    return failure(status.code(), "the pictures cannot be classified: %s", describe(status.code()));
  }

  struct Grown {
    std::size_t scene, color;
    GrownPatch patch;
  };
  const ColorFitInput& input_;
  ColorFit out_;
  std::unique_ptr<Scan> scan_;
  std::vector<Scene> scenes_;
  std::vector<std::uint8_t> inside_;
  std::vector<Grown> patches_;
  std::vector<std::size_t> patch_area_;  // for each color, median over its clicks
};

}  // namespace

Result<ColorFit> fit_colors(const ColorFitInput& input) { return Fitter(input).run(); }

std::vector<std::uint8_t> preview_rgb(const ColorFitInput& input, const ColorFit& fit, const CameraPicture& picture) {
  const ChannelImage channels = corrected_channels(picture.frame(), Shading{});
  std::vector<std::uint8_t> out(3 * channels.pixels.size());
  for (std::size_t i = 0; i < channels.pixels.size(); ++i) {
    const Channels& p = channels.pixels[i];
    const int grey = is_yuv(fit.space) ? p[0] : (p[0] + 2 * p[1] + p[2]) / 4;
    for (std::size_t c = 0; c < 3; ++c) out[3 * i + c] = static_cast<std::uint8_t>(grey / 3);
  }
  const auto scanned = std::make_unique<Scan>();
  if (!scan(input, fit.learned.boxes, picture, *scanned).ok()) return out;
  for (const Region& region : scanned->regions) {
    const Channels& shown = fit.shown_rgb[region.color - 1U];
    each_pixel(scanned->runs, region, [&](int u, int v) {
      for (std::size_t c = 0; c < 3; ++c) out[3 * channels.index(u, v) + c] = shown[c];
    });
  }
  return out;
}

}  // namespace touchline::calibrate
