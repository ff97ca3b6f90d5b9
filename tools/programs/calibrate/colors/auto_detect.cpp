#include "tools/programs/calibrate/colors/auto_detect.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "tools/programs/calibrate/colors/ball_inference.h"
#include "tools/programs/calibrate/colors/marker_completion.h"
#include "tools/programs/calibrate/colors/patch_selection.h"
#include "tools/programs/calibrate/colors/robot_inference.h"
#include "tools/programs/calibrate/colors/unlearned_patches.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/command_line/progress.h"
#include "tools/programs/replay/canvas.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

// Largest elongation of a ball. Shadow and motion elongate a ball up to this value; the end of a line is longer.
constexpr double kBallElongation = 1.6;

std::vector<PatchSize> sizes_of(const MarkerParameters& marker) {
  std::vector<PatchSize> sizes;
  for (const TeamMarking& team : marker.teams) {
    if (team.team_color == kBackground) continue;
    for (const PatchPlace& place : team.layout.patches) sizes.push_back(size_of(place, team.layout));
  }
  if (marker.ball.color != kBackground) sizes.push_back(size_of(marker.ball));
  return sizes;
}

// Selects the patches to learn from: patches with the usual area, evenness and appearance for their color. A region
// that grew into a neighbor or beyond its edge would give a wrong color. A patch that was clicked on has the right
// appearance, even if the others look different.
std::vector<std::size_t> cleanest(const AssignmentInput& input, const AssignedColor& color,
                                  const std::vector<const ChannelImage*>& images) {
  struct Measure {
    double uneven, area, unlike;
  };
  std::vector<Measure> measures;
  const Lab lab = lab_of(color.rgb);
  for (const std::size_t p : color.patches) {
    const FoundPatch& patch = input.patches[p];
    const ChannelImage& image = *images[input.picture[p]];
    std::array<double, 3> sum{}, squares{};
    for (const std::size_t pixel : patch.pixels) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = image.pixels[pixel][c];
        sum[c] += x;
        squares[c] += x * x;
      }
    }
    const auto count = static_cast<double>(patch.pixels.size());
    double variance = 0;
    for (std::size_t c = 0; c < 3; ++c) variance += squares[c] / count - sum[c] / count * (sum[c] / count);
    measures.push_back({std::sqrt(std::max(0.0, variance)), count, difference(patch.lab, lab)});
  }
  const auto usual = [&](double Measure::*what) {
    std::vector<double> values;
    values.reserve(measures.size());
    for (const Measure& m : measures) values.push_back(m.*what);
    // Of two values, the lower median is the better one.
    return statistics::lower_median(values);
  };
  if (measures.empty()) return {};
  const double uneven = usual(&Measure::uneven), area = usual(&Measure::area), unlike = usual(&Measure::unlike);
  constexpr double kMoreUneven = 1.5, kLarger = 1.6, kUnlike = 6.0;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < measures.size(); ++i) {
    const Measure& m = measures[i];
    const bool alike = input.named[color.patches[i]] != kNone || m.unlike <= 2 * unlike + kUnlike;
    if (m.uneven <= kMoreUneven * uneven && m.area <= kLarger * area && alike) {
      out.push_back(color.patches[i]);
    }
  }
  if (!out.empty()) return out;
  // If no patch is usual in all measures, take the most even one, which has the fewest pixels of other colors.
  const auto most_even = std::min_element(measures.begin(), measures.end(),
                                          [](const Measure& a, const Measure& b) { return a.uneven < b.uneven; });
  return {color.patches[static_cast<std::size_t>(most_even - measures.begin())]};
}

// Adds all pixels that the robot with this team patch can cover.
void add_robot(const FoundPatch& patch, const ChannelImage& image, const CameraModel& camera,
               const MarkerLayout& layout, std::vector<std::size_t>& out) {
  const float scale = camera.scale_px_per_m(camera.to_field(patch.center, layout.height_m), layout.height_m);
  const int radius = std::clamp(static_cast<int>(std::ceil(layout.robot_side_m * scale)), 1, 200);
  const int u = static_cast<int>(std::lround(patch.center.u_px)), v = static_cast<int>(std::lround(patch.center.v_px));
  for (int dv = -radius; dv <= radius; ++dv) {
    for (int du = -radius; du <= radius; ++du) {
      if (du * du + dv * dv <= radius * radius && image.contains(u + du, v + dv))
        out.push_back(image.index(u + du, v + dv));
    }
  }
}

// The patch that a click marks, and how.
struct Marked {
  std::size_t patch = kNone;
  std::optional<std::array<double, 4>> box = {};  // the patch was selected by this rectangle
  bool by_click = false;                          // learn from the click's place instead of the patch's seed
};

// Returns true if the region around the patch's seed does not contain the click, and the one around the click looks
// more like the color's name: in the middle of a ball that the search met at its shaded rim, for example, but not on a
// highlight.
bool has_better_shade(const Click& click, const FoundPatch& patch, const ChannelImage& image,
                      const std::vector<std::uint8_t>& inside) {
  const std::optional<Rgb> look = usual_rgb(click.color);
  const auto u = static_cast<int>(std::lround(click.u_px)), v = static_cast<int>(std::lround(click.v_px));
  if (click.box || !look || !image.contains(u, v)) return false;
  GrowthLimits limits;
  limits.radius_px = patch.radius_px;
  const auto grown_from = [&](double u_px, double v_px) -> Result<FoundPatch> {
    Click at = click;
    at.u_px = u_px;
    at.v_px = v_px;
    TOUCHLINE_TRY_ASSIGN(GrownPatch grown, select_patch(image, inside, at, limits));
    return patch_of(image, {static_cast<float>(u_px), static_cast<float>(v_px)}, limits.radius_px, std::move(grown));
  };
  const Result<FoundPatch> by_click = grown_from(click.u_px, click.v_px), by_seed = grown_from(patch.u_px, patch.v_px);
  if (!by_click.ok() || !by_seed.ok()) return false;
  const std::vector<std::size_t>& pixels = by_seed.value().pixels;
  if (std::find(pixels.begin(), pixels.end(), image.index(u, v)) != pixels.end()) return false;
  const Lab wanted = lab_of(*look);
  return difference(by_click.value().lab, wanted) < difference(by_seed.value().lab, wanted);
}

// Names the marked patches by their clicks, except the clicks in `left_out`.
void name_patches(const std::vector<Click>& clicks, const std::vector<Marked>& marked,
                  const std::vector<bool>& left_out, DetectedColors& out) {
  AssignmentInput& input = out.input;
  input.named.assign(input.patches.size(), kNone);
  for (WantedColor& color : input.colors) color.clicked = false;
  for (std::size_t i = 0; i < clicks.size(); ++i) {
    out.uses[i].used = false;
    if (marked[i].patch == kNone || left_out[i]) continue;
    const auto color = std::find_if(input.colors.begin(), input.colors.end(),
                                    [&](const WantedColor& w) { return w.name == clicks[i].color; });
    std::size_t& name = input.named[marked[i].patch];
    if (color == input.colors.end()) {
      out.uses[i].reason = "the team file has no color " + clicks[i].color;
    } else if (const auto number = static_cast<std::size_t>(color - input.colors.begin());
               name != kNone && name != number) {
      out.uses[i].reason = "an earlier click names the same patch " + input.colors[name].name;
    } else {
      name = number;
      color->clicked = true;
      out.uses[i] = {true, ""};
    }
  }
}

// Returns whether a picture shows more patches than two complete teams have.
bool is_cluttered(const DetectedColors& found) {
  std::vector<std::size_t> grown(found.images.size(), 0);
  for (std::size_t p = 0; p < found.input.patches.size(); ++p) {
    if (!found.input.patches[p].sampled) ++grown[found.input.picture[p]];
  }
  return std::any_of(grown.begin(), grown.end(), [](std::size_t count) { return count > kPatchesOfTwoTeams; });
}

// Assigns colors with the clicks. A click is left out if more robots are recognized without it, as long as fewer are
// recognized than without any click.
void assign_with_clicks(const std::vector<Click>& clicks, const std::vector<Marked>& marked, DetectedColors& out) {
  std::vector<bool> left_out(clicks.size(), true);
  name_patches(clicks, marked, left_out, out);
  const Assignment without_clicks = assign_colors(out.input);
  left_out.assign(clicks.size(), false);
  name_patches(clicks, marked, left_out, out);
  out.assignment = assign_colors(out.input);
  // A click outweighs robots without ids, and outweighs all robots that a textured floor seems to show: of many
  // patches, some are arranged like a robot by chance.
  while (!is_cluttered(out) && out.assignment.named.size() < without_clicks.named.size()) {
    std::size_t worst = clicks.size();
    Assignment best = out.assignment;
    for (std::size_t i = 0; i < clicks.size(); ++i) {
      if (!out.uses[i].used) continue;
      left_out[i] = true;
      name_patches(clicks, marked, left_out, out);
      Assignment tried = assign_colors(out.input);
      left_out[i] = false;
      name_patches(clicks, marked, left_out, out);
      if (tried.named.size() <= best.named.size()) continue;
      best = std::move(tried);
      worst = i;
    }
    if (worst == clicks.size()) break;
    out.uses[worst].reason = formatted("with it %zu robots are recognized, without it %zu; is its color right?",
                                       out.assignment.named.size(), best.named.size());
    left_out[worst] = true;
    name_patches(clicks, marked, left_out, out);
    out.assignment = std::move(best);
  }
  // If a click resolves a doubt, leaving the click out would only make the doubt ask for it again.
  bool restored = false;
  for (const DetectionDoubt& doubt : detection_doubts(out.input, out.assignment, out.images, {})) {
    for (std::size_t i = 0; i < clicks.size(); ++i) {
      if (!left_out[i] || doubt.color == kNone || clicks[i].color != out.input.colors[doubt.color].name) continue;
      left_out[i] = false;
      restored = true;
    }
  }
  if (restored) {
    name_patches(clicks, marked, left_out, out);
    out.assignment = assign_colors(out.input);
  }
  // A color that was certain without the clicks stays certain.
  for (std::size_t c = 0; c < out.assignment.colors.size(); ++c) {
    AssignedColor& color = out.assignment.colors[c];
    const AssignedColor& before = without_clicks.colors[c];
    if (!color.patches.empty() && !before.patches.empty() && difference(lab_of(color.rgb), lab_of(before.rgb)) < kSame)
      color.margin = std::max(color.margin, before.margin);
  }
}

}  // namespace

Result<DetectedColors> auto_detect_colors(const VenueDraft& venue, const TeamColors& team,
                                          const std::vector<Click>& clicks,
                                          const std::map<std::string, CameraPicture>& pictures) {
  if (!has_camera_model(venue)) {
    return Error{ErrorCode::kNotFound, "without clicks, the camera model is needed: calibrate the field first"};
  }
  CameraModel camera;
  if (Status s = camera.configure(venue.file.camera_model); !s.ok()) {
    return failure(s.code(), "the camera model is invalid: %s", describe(s.code()));
  }
  const Frame first = pictures.begin()->second.frame();
  auto shading = std::make_unique<Shading>();
  if (venue.light.columns > 0) {
    if (Status s = shading->build(venue.light, first.width_px, first.height_px, color_space(first.format)); !s.ok()) {
      return failure(s.code(), "the light map does not fit the pictures: %s", describe(s.code()));
    }
  }
  const auto inside = inside_mask(venue.region_of_interest, first.width_px, first.height_px);
  std::map<std::string, ChannelImage> images;
  for (const auto& [image, picture] : pictures) {
    const Frame frame = picture.frame();
    if (frame.width_px != first.width_px || frame.height_px != first.height_px) {
      return failure(ErrorCode::kInconsistent,
                     "%s is %u x %u, %s is %u x %u: all pictures must have the size of the camera's frames",
                     image.c_str(), frame.width_px, frame.height_px, pictures.begin()->first.c_str(), first.width_px,
                     first.height_px);
    }
    images[image] = corrected_channels(frame, *shading);
  }

  DetectedColors out;
  AssignmentInput& input = out.input;
  input.teams = team.marker.teams;
  input.ball = team.marker.ball.color;
  for (const std::string& name : team.names) input.colors.push_back({name, usual_rgb(name), false});
  const std::vector<PatchSize> sizes = sizes_of(team.marker);
  std::vector<const ChannelImage*> searched;
  std::deque<LocalBackground> floors;
  std::vector<SearchedPicture> sampled;
  std::vector<Marked> marked(clicks.size());
  out.uses.resize(clicks.size());
  Progress progress("searching for patches in pictures", images.size());
  for (const auto& [image, channels] : images) {
    const LocalBackground& floor = floors.emplace_back(channels, inside);
    std::vector<FoundPatch> patches = find_patches(channels, inside, floor, camera, venue.file.field, sizes);
    for (std::size_t i = 0; i < clicks.size(); ++i) {
      if (clicks[i].image != image) continue;
      const std::size_t under = patch_under(clicks[i], channels, patches);
      marked[i].patch = input.patches.size() + under;
      if (under < patches.size()) {
        marked[i].by_click = has_better_shade(clicks[i], patches[under], channels, inside);
        continue;
      }
      Result<FoundPatch> grown = patch_from(clicks[i], channels, inside, camera, sizes);
      if (grown.ok()) {
        patches.push_back(std::move(grown).value());
        marked[i].box = clicks[i].box;
      } else {
        marked[i].patch = kNone;
        out.uses[i].reason = grown.text();
        const int u = static_cast<int>(clicks[i].u_px), v = static_cast<int>(clicks[i].v_px);
        // There is an object here, although its outline is unclear.
        if (channels.contains(u, v)) out.unclear[image].push_back(channels.index(u, v));
      }
    }
    std::vector<std::size_t> numbers;
    for (FoundPatch& patch : patches) {
      if (input.ball != kBackground && patch.elongation < kBallElongation) {
        const double relative = relative_area(patch, camera, size_of(team.marker.ball));
        if (relative >= kMinRelativeArea && relative <= kMaxRelativeArea) input.balls.push_back(input.patches.size());
      }
      numbers.push_back(input.patches.size());
      input.patches.push_back(std::move(patch));
      input.picture.push_back(out.images.size());
    }
    for (std::size_t t = 0; t < 2; ++t) {
      if (input.teams[t].team_color == kBackground) continue;
      const MarkerLayout& layout = input.teams[t].layout;
      std::vector<MarkerCandidate> markers = find_markers(input.patches, numbers, layout, camera);
      for (MarkerCandidate& marker :
           complete_markers(input.patches, numbers, {layout, camera, {channels, inside, floor}}))
        markers.push_back(std::move(marker));
      for (MarkerCandidate& marker : markers) {
        marker.team = t;
        marker.picture = out.images.size();
        input.markers.push_back(std::move(marker));
      }
    }
    input.picture.resize(input.patches.size(), out.images.size());  // entries of the patches that were sampled
    sampled.push_back({out.images.size(), {channels, inside, floor}});
    out.images.push_back(image);
    searched.push_back(&channels);
    progress.step();
  }
  assign_with_clicks(clicks, marked, out);
  infer_robots(input, camera, sampled, out.assignment);
  infer_ball(input, camera, size_of(team.marker.ball), sampled, out.assignment);
  out.doubts = detection_doubts(input, out.assignment, out.images, clicks);
  out.unlisted = describe_unlisted(input, out.assignment, out.images);
  std::vector<PatchPicture> all;
  all.reserve(searched.size());
  for (const ChannelImage* image : searched) all.push_back({*image, inside});
  out.scales = patch_scales(input, out.assignment, all, camera);
  leave_out_similar(out);
  find_things(camera, out);
  for (std::size_t c = 0; c < input.colors.size(); ++c) {
    const AssignedColor& color = out.assignment.colors[c];
    for (const auto* patches : {&color.patches, &color.others}) {
      for (const std::size_t p : *patches) {
        std::vector<std::size_t>& unclear = out.unclear[out.images[input.picture[p]]];
        unclear.insert(unclear.end(), input.patches[p].pixels.begin(), input.patches[p].pixels.end());
      }
    }
    for (const TeamMarking& marking : input.teams) {
      if (marking.team_color != c + 1) continue;
      for (const std::size_t p : color.others) {
        add_robot(input.patches[p], *searched[input.picture[p]], camera, marking.layout,
                  out.unclear[out.images[input.picture[p]]]);
      }
    }
    // All patches of robots are used, because they show every shade of a paint under these lamps; of the ball only the
    // cleanest, because its rim has another color.
    for (const std::size_t p : c + 1 == input.ball ? cleanest(input, color, searched) : color.patches) {
      const FoundPatch& patch = input.patches[p];
      Click click{out.images[input.picture[p]], input.colors[c].name, patch.u_px, patch.v_px, patch.radius_px, {}};
      if (patch.sampled) click.pixels = patch.pixels;  // growing a region did not find this patch
      click.usual = patch.usual;
      for (std::size_t i = 0; i < marked.size(); ++i) {
        if (marked[i].patch != p || !out.uses[i].used) continue;
        click.box = marked[i].box;
        if (!marked[i].by_click) continue;
        click.u_px = clicks[i].u_px;
        click.v_px = clicks[i].v_px;
      }
      out.clicks.push_back(click);
    }
  }
  return out;
}

Result<void> write_detection_picture(const std::string& path, const DetectedColors& found, const std::string& image,
                                     const CameraPicture& picture) {
  const auto number =
      static_cast<std::size_t>(std::find(found.images.begin(), found.images.end(), image) - found.images.begin());
  const replay::SurfacePtr surface = replay::to_surface(picture.frame());
  const replay::ContextPtr context(cairo_create(surface.get()));
  const int width = picture.frame().width_px;
  std::vector<std::size_t> color_of(found.input.patches.size(), found.input.colors.size());
  for (std::size_t c = 0; c < found.assignment.colors.size(); ++c) {
    for (const std::size_t p : found.assignment.colors[c].patches) color_of[p] = c;
  }
  for (const AssignedRobot& robot : found.assignment.named) {  // including robots that nothing is learned from
    const TeamMarking& team = found.input.teams[robot.team];
    color_of[robot.patches[0]] = team.team_color - std::size_t{1};
    for (std::size_t k = 1; k < robot.patches.size(); ++k)
      color_of[robot.patches[k]] = team.robots[robot.robot].colors[k - 1] - std::size_t{1};
  }
  for (std::size_t p = 0; p < color_of.size(); ++p) {
    if (found.input.picture[p] != number) continue;
    const FoundPatch& patch = found.input.patches[p];
    int left = width, right = 0, top = picture.frame().height_px, bottom = 0;
    for (const std::size_t pixel : patch.pixels) {
      const int u = static_cast<int>(pixel) % width, v = static_cast<int>(pixel) / width;
      left = std::min(left, u);
      right = std::max(right, u + 1);
      top = std::min(top, v);
      bottom = std::max(bottom, v + 1);
    }
    const bool named = color_of[p] < found.input.colors.size();
    cairo_set_line_width(context.get(), named ? 1.5 : 0.75);
    replay::set_color(*context, named ? replay::CanvasColor{1, 1, 1} : replay::CanvasColor{0.6, 0.6, 0.6});
    cairo_rectangle(context.get(), left - 1, top - 1, right - left + 2, bottom - top + 2);
    cairo_stroke(context.get());
    if (named) {
      replay::draw_text(*context, right + 3, bottom, found.input.colors[color_of[p]].name,
                        replay::canvas_color(patch.rgb), 11);
    }
  }
  return replay::write_png(*surface, path);
}

}  // namespace touchline::calibrate
