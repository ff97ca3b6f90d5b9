#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/relight/changed_series.h"
#include "tools/programs/relight/illumination_plots.h"
#include "tools/programs/relight/same_color.h"

namespace touchline::relight {
namespace {

using calibrate::ChannelImage;

struct Options {
  std::string picture, venue, out, things, channel = "red";
  std::vector<double> patch;
  int margin = 25;
  PictureChange change;
  std::vector<double> values;
  std::uint64_t every = 0;
};

// Draws the figures of one picture and writes their files.
class Figures {
 public:
  Figures(const LightMap& map, const ChannelImage& picture, std::string stem)
      : map_(map),
        width_(static_cast<std::size_t>(picture.width_px)),
        height_(static_cast<std::size_t>(picture.height_px)),
        stem_(std::move(stem)) {}

  [[nodiscard]] Result<void> write(const replay::SurfacePtr& surface, const std::string& name) const {
    const std::string path = stem_ + "-" + name + ".png";
    TOUCHLINE_TRY(replay::write_png(*surface, path));
    std::printf("%s written\n", path.c_str());
    return {};
  }

  [[nodiscard]] replay::SurfacePtr picture(const ChannelImage& image, bool contours) const {
    replay::SurfacePtr surface = paint([&](std::size_t i) { return image.pixels[i]; });
    if (contours) draw_contours(*replay::ContextPtr(cairo_create(surface.get())), map_, width_, height_, true);
    return surface;
  }

  // Returns a picture with recognized pixels in black and a circle around each patch; the circle is red around the
  // patch that defines the thresholds.
  [[nodiscard]] replay::SurfacePtr classified(const std::vector<std::uint8_t>& pixels, const SameColor& color) const {
    using Channels = calibrate::Channels;
    replay::SurfacePtr surface = paint([&](std::size_t i) {
      return pixels[i] != 0 ? Channels{0, 0, 0} : Channels{255, 255, 255};
    });
    const replay::ContextPtr context(cairo_create(surface.get()));
    draw_contours(*context, map_, width_, height_, false);
    for (std::size_t i = 0; i < color.patches.size(); ++i) {
      const calibrate::FoundPatch& patch = color.patches[i];
      const double radius = std::sqrt(static_cast<double>(patch.pixels.size())) + 2;
      cairo_new_sub_path(context.get());
      cairo_arc(context.get(), static_cast<double>(patch.center.u_px) + 0.5,
                static_cast<double>(patch.center.v_px) + 0.5, radius, 0, 6.2832);
      replay::set_color(*context, i == color.representative ? replay::CanvasColor{0.85, 0.1, 0.1}
                                                            : replay::CanvasColor{0.6, 0.6, 0.6});
      cairo_set_line_width(context.get(), 1.2);
      cairo_stroke(context.get());
    }
    return surface;
  }

 private:
  template <class Color>
  [[nodiscard]] replay::SurfacePtr paint(Color&& color) const {
    hal::Picture picture;
    picture.width_px = static_cast<std::uint32_t>(width_);
    picture.height_px = static_cast<std::uint32_t>(height_);
    picture.rgb8.reserve(3 * width_ * height_);
    for (std::size_t i = 0; i < width_ * height_; ++i) {
      const calibrate::Channels value = color(i);
      picture.rgb8.insert(picture.rgb8.end(), value.begin(), value.end());
    }
    return replay::to_surface(calibrate::frame_of(picture));
  }
  const LightMap& map_;
  std::size_t width_, height_;
  std::string stem_;
};

Result<void> change_pictures(const Options& options) {
  PictureChange change = options.change;
  if (!options.values.empty()) std::copy(options.values.begin(), options.values.end(), change.values.begin());
  const std::uint64_t every = options.every == 0 ? 1 : options.every;
  Things things;
  if (!options.things.empty()) {
    TOUCHLINE_TRY_ASSIGN(things, read_things(options.things));
  }
  TOUCHLINE_TRY_ASSIGN(const std::uint64_t written, change_series(options.picture, options.out, change, things, every));
  std::printf("%llu pictures written to %s\n", static_cast<unsigned long long>(written), options.out.c_str());
  return {};
}

Result<void> draw_figures(const Options& options) {
  namespace fs = std::filesystem;
  if (options.venue.empty()) return Error{ErrorCode::kOutOfRange, "needs --venue, or a change such as --light 0.5"};
  TOUCHLINE_TRY_ASSIGN(const calibrate::VenueDraft draft, calibrate::read_draft(options.venue));
  if (draft.light.columns == 0)
    return Error{ErrorCode::kInconsistent,
                 options.venue + ": the section [light] is missing; run touchline-calibrate light"};
  std::optional<std::array<double, 2>> at;
  if (!options.patch.empty()) {
    if (!std::isfinite(options.patch[0]) || !std::isfinite(options.patch[1]))
      return Error{ErrorCode::kInconsistent, "--patch: needs two numbers"};
    at = {options.patch[0], options.patch[1]};
  }
  TOUCHLINE_TRY_ASSIGN(const calibrate::CameraPicture picture,
                       calibrate::CameraPicture::load(options.picture, PixelFormat::kRgb24));
  const Frame frame = picture.frame();
  const auto shading = std::make_unique<Shading>();
  if (Status s = shading->build(draft.light, frame.width_px, frame.height_px, ColorSpace::kRgb); !s.ok()) {
    return Error{ErrorCode::kInconsistent, std::string("the light map is invalid: ") + describe(s.code())};
  }
  const ChannelImage acquired = calibrate::corrected_channels(frame, Shading{});
  const ChannelImage corrected = calibrate::corrected_channels(frame, *shading);
  Result<SameColor> same_color = find_same_color(corrected, draft, at ? &*at : nullptr);
  if (!same_color.ok()) return prefixed(options.picture, std::move(same_color).error());
  const SameColor& color = same_color.value();

  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return Error{ErrorCode::kInconsistent, options.out + ": cannot be created: " + error.message()};
  const Figures figures(draft.light, acquired, (fs::path(options.out) / fs::path(options.picture).stem()).string());
  const std::size_t channel = options.channel == "red" ? 0 : options.channel == "green" ? 1 : 2;
  const calibrate::FoundPatch& sample = color.patches[color.representative];
  const auto before = classify(acquired, thresholds_of(acquired, sample, options.margin));
  const auto after = classify(corrected, thresholds_of(corrected, sample, options.margin));
  TOUCHLINE_TRY(figures.write(draw_component(draft.light, channel, frame.width_px, frame.height_px), "figure8"));
  TOUCHLINE_TRY(figures.write(figures.picture(acquired, true), "figure13"));
  TOUCHLINE_TRY(figures.write(figures.classified(before, color), "figure14"));
  TOUCHLINE_TRY(figures.write(figures.classified(after, color), "figure15"));
  TOUCHLINE_TRY(figures.write(figures.picture(corrected, false), "corrected"));
  std::printf(
      "%zu patches of the color at %.0f,%.0f, thresholds from that one and %d levels more: %zu recognized in the "
      "picture as it came, "
      "%zu in the corrected one\n",
      color.patches.size(), static_cast<double>(sample.center.u_px), static_cast<double>(sample.center.v_px),
      options.margin, recognized(color, before), recognized(color, after));
  return {};
}

}  // namespace
}  // namespace touchline::relight

int main(int argc, char** argv) {
  touchline::relight::Options options;
  CLI::App app(
      "Figures 8 and 13 to 15 of Klancar et al. for any picture with patches of one color all over the field:\n"
      "NAME-figure8.png the illumination map as a surface, NAME-figure13.png the picture with contours of the\n"
      "illumination, NAME-figure14.png and NAME-figure15.png the pixels between thresholds from one patch, before and\n"
      "after the correction, NAME-corrected.png. Prints how many of the patches are recognized in each.\n"
      "With a change (--light to --every) it writes the changed pictures instead, NAME.png: with them, a calibration "
      "can\n"
      "be tested under light that it was not made for",
      "touchline-relight");
  app.add_option("picture", options.picture, "A picture, or a video (its first frame); for a change, also a folder")
      ->required()
      ->type_name("PATH");
  app.add_option("--venue", options.venue, "Venue file with light map and camera model, for the figures")
      ->type_name("FILE");
  app.add_option("--out", options.out, "Folder for the pictures; created if it does not exist")
      ->required()
      ->type_name("DIR");
  app.add_option("--patch", options.patch,
                 "Pixel U,V of the patch that defines the thresholds (default: of the most frequent color, the patch "
                 "nearest to the center)")
      ->delimiter(',')
      ->expected(2);
  app.add_option("--channel", options.channel, "Channel of figure 8")
      ->check(touchline::one_of({"red", "green", "blue"}))
      ->capture_default_str();
  app.add_option("--margin", options.margin, "Levels added to the range of the patch's pixels on each side")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  std::vector<CLI::Option*> changes;
  const auto add_change = [&](const char* name, auto& value, const char* text, CLI::Validator range) {
    changes.push_back(app.add_option(name, value, text)->check(std::move(range))->group("Changes"));
    return changes.back();
  };
  add_change("--light", options.change.light, "Factor of the light, for a camera with a gamma of 2.2",
             touchline::number_range(0.01, 100));
  add_change("--shadow", options.change.shadow, "Factor of the light in the left half of the picture",
             touchline::number_range(0.01, 100));
  add_change("--blur", options.change.blur_px, "Standard deviation of a Gaussian, px", touchline::number_range(0, 50));
  add_change("--values", options.values, "Factors R,G,B of the pixel values", touchline::number_range(0.01, 100))
      ->delimiter(',')
      ->expected(3);
  add_change("--jpeg", options.change.jpeg_quality, "What JPEG compression with this quality leaves of the picture",
             CLI::Range(1, 100));
  changes.push_back(
      app.add_option("--things", options.things,
                     "JSON file with things to paint into the pictures: {\"NAME.png\": [{\"kind\": paper, "
                     "hand, shoe or robot, \"u\", \"v\", \"size\": px, \"colors\": [{\"rgb\": [R,G,B]} or "
                     "{\"like\": [U,V]}]}]}; glare, the image of a lamp, has \"light\" (0 to 1) instead of colors")
          ->type_name("FILE")
          ->group("Changes"));
  add_change("--every", options.every, "Only every n-th picture or frame", CLI::Range(1, 1000000));
  touchline::add_examples(
      app, {{"touchline-relight robots.png --venue venue.toml --out figures", "draw the figures"},
            {"touchline-relight pictures --light 0.5 --out darker", "write pictures with half the light"}});
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;
  const bool change = std::any_of(changes.begin(), changes.end(), [](const CLI::Option* o) { return o->count() > 0; });
  const touchline::Result<void> done =
      change ? touchline::relight::change_pictures(options) : touchline::relight::draw_figures(options);
  return done.ok() ? touchline::kExitOk : touchline::fail("touchline-relight", done.text());
}
