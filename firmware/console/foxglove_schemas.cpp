#include "firmware/console/foxglove_schemas.h"

#include <initializer_list>
#include <utility>

namespace touchline::console {
namespace {

const std::string number_type = R"({"type":"number"})", integer_type = R"({"type":"integer"})",
                  text_type = R"({"type":"string"})", flag_type = R"({"type":"boolean"})";

std::string object_type(std::string_view title, std::initializer_list<std::pair<const char*, std::string>> members) {
  std::string text = R"({"type":"object","title":")" + std::string(title) + R"(","properties":{)";
  bool is_first = true;
  for (const auto& [name, type] : members) {
    text += (std::exchange(is_first, false) ? "\"" : ",\"") + std::string(name) + "\":" + type;
  }
  return text + "}}";
}

std::string list_type(const std::string& element) { return R"({"type":"array","items":)" + element + "}"; }

// Foxglove recognizes times and durations by their titles.
std::string time_type(std::string_view title = "time") {
  return object_type(title, {{"sec", integer_type}, {"nsec", integer_type}});
}

std::string vector_type(std::string_view title) {
  return object_type(title, {{"x", number_type}, {"y", number_type}, {"z", number_type}});
}

std::string pixel_type() { return object_type("foxglove.Point2", {{"x", number_type}, {"y", number_type}}); }

std::string color_type() {
  return object_type("foxglove.Color",
                     {{"r", number_type}, {"g", number_type}, {"b", number_type}, {"a", number_type}});
}

std::string pose_type() {
  return object_type(
      "foxglove.Pose",
      {{"position", vector_type("foxglove.Vector3")},
       {"orientation", object_type("foxglove.Quaternion",
                                   {{"x", number_type}, {"y", number_type}, {"z", number_type}, {"w", number_type}})}});
}

std::string picture_type() {
  return object_type("foxglove.CompressedImage", {{"timestamp", time_type()},
                                                  {"frame_id", text_type},
                                                  {"data", R"({"type":"string","contentEncoding":"base64"})"},
                                                  {"format", text_type}});
}

std::string annotations_type() {
  const std::string circle = object_type("foxglove.CircleAnnotation", {{"timestamp", time_type()},
                                                                       {"position", pixel_type()},
                                                                       {"diameter", number_type},
                                                                       {"thickness", number_type},
                                                                       {"fill_color", color_type()},
                                                                       {"outline_color", color_type()}});
  const std::string points = object_type("foxglove.PointsAnnotation", {{"timestamp", time_type()},
                                                                       {"type", integer_type},
                                                                       {"points", list_type(pixel_type())},
                                                                       {"outline_color", color_type()},
                                                                       {"fill_color", color_type()},
                                                                       {"thickness", number_type}});
  const std::string text = object_type("foxglove.TextAnnotation", {{"timestamp", time_type()},
                                                                   {"position", pixel_type()},
                                                                   {"text", text_type},
                                                                   {"font_size", number_type},
                                                                   {"text_color", color_type()},
                                                                   {"background_color", color_type()}});
  return object_type("foxglove.ImageAnnotations",
                     {{"circles", list_type(circle)}, {"points", list_type(points)}, {"texts", list_type(text)}});
}

std::string scene_type() {
  const std::string body = vector_type("foxglove.Vector3");
  const std::string cube =
      object_type("foxglove.CubePrimitive", {{"pose", pose_type()}, {"size", body}, {"color", color_type()}});
  const std::string sphere =
      object_type("foxglove.SpherePrimitive", {{"pose", pose_type()}, {"size", body}, {"color", color_type()}});
  const std::string line = object_type("foxglove.LinePrimitive", {{"type", integer_type},
                                                                  {"pose", pose_type()},
                                                                  {"thickness", number_type},
                                                                  {"scale_invariant", flag_type},
                                                                  {"points", list_type(vector_type("foxglove.Point3"))},
                                                                  {"color", color_type()}});
  const std::string text = object_type("foxglove.TextPrimitive", {{"pose", pose_type()},
                                                                  {"billboard", flag_type},
                                                                  {"font_size", number_type},
                                                                  {"scale_invariant", flag_type},
                                                                  {"color", color_type()},
                                                                  {"text", text_type}});
  const std::string entity = object_type("foxglove.SceneEntity", {{"timestamp", time_type()},
                                                                  {"frame_id", text_type},
                                                                  {"id", text_type},
                                                                  {"lifetime", time_type("duration")},
                                                                  {"frame_locked", flag_type},
                                                                  {"cubes", list_type(cube)},
                                                                  {"spheres", list_type(sphere)},
                                                                  {"lines", list_type(line)},
                                                                  {"texts", list_type(text)}});
  const std::string deletion = object_type("foxglove.SceneEntityDeletion",
                                           {{"timestamp", time_type()}, {"type", integer_type}, {"id", text_type}});
  return object_type("foxglove.SceneUpdate", {{"deletions", list_type(deletion)}, {"entities", list_type(entity)}});
}

// Returns the schema of those members of the message `state` that panels for plots need.
std::string state_type() {
  const std::string ball =
      object_type("touchline.BallTrack",
                  {{"x_m", number_type}, {"y_m", number_type}, {"vx_mps", number_type}, {"vy_mps", number_type}});
  const std::string track = object_type("touchline.RobotTrack", {{"team", text_type},
                                                                 {"id", integer_type},
                                                                 {"x_m", number_type},
                                                                 {"y_m", number_type},
                                                                 {"heading_rad", number_type},
                                                                 {"speed_mps", number_type},
                                                                 {"turn_radps", number_type}});
  const std::string command =
      object_type("touchline.Command",
                  {{"id", integer_type}, {"left_mps", number_type}, {"right_mps", number_type}, {"source", text_type}});
  return object_type("touchline.State", {{"number", integer_type},
                                         {"captured_s", number_type},
                                         {"latency_ms", number_type},
                                         {"ball_track", ball},
                                         {"tracks", list_type(track)},
                                         {"commands", list_type(command)},
                                         {"stop", flag_type},
                                         {"halt", list_type(text_type)},
                                         {"brightness", number_type},
                                         {"stages_ms", list_type(number_type)}});
}

}  // namespace

FoxgloveSchema foxglove_schema(FoxgloveChannel channel) {
  switch (channel) {
    case FoxgloveChannel::kState:
      return {"/state", "touchline.State", state_type()};
    case FoxgloveChannel::kScene:
      return {"/field/scene", "foxglove.SceneUpdate", scene_type()};
    case FoxgloveChannel::kAnnotations:
      return {"/camera/annotations", "foxglove.ImageAnnotations", annotations_type()};
    case FoxgloveChannel::kPicture:
      return {"/camera/picture", "foxglove.CompressedImage", picture_type()};
  }
  return {};
}

}  // namespace touchline::console
