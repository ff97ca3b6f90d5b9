#include "tests/setup/scripted_firmware.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>

#include "hal/mock/sensor.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t kWidth = 640, kHeight = 480;

}  // namespace

hal::Picture arena_picture(hal::mock::Floor floor, std::uint64_t seed) {
  const hal::mock::ArenaParameters arena;
  hal::mock::Renderer renderer(arena, kWidth, kHeight, floor);
  hal::mock::Sensor sensor(arena.sensor, PixelFormat::kRgb24, kWidth, kHeight, seed);
  hal::Picture picture{kWidth, kHeight, std::vector<std::uint8_t>(std::size_t{3} * kWidth * kHeight), {}};
  sensor.expose(renderer.render_floor(), picture.rgb8);
  return picture;
}

std::vector<hal::Picture> scene_pictures(arena::SceneKind kind, unsigned count, std::uint64_t seed) {
  const hal::mock::ArenaParameters arena;
  hal::mock::Renderer renderer(arena, kWidth, kHeight, hal::mock::Floor::kField);
  hal::mock::Sensor sensor(arena.sensor, PixelFormat::kRgb24, kWidth, kHeight, seed);
  std::vector<hal::Picture> pictures;
  for (const arena::SceneFrame& frame : arena::make_scene(kind, arena, 60.0, count, seed)) {
    hal::Picture& picture = pictures.emplace_back();
    picture = {kWidth, kHeight, std::vector<std::uint8_t>(std::size_t{3} * kWidth * kHeight), {}};
    sensor.expose(renderer.render(frame.begin, frame.end), picture.rgb8);
  }
  return pictures;
}

void ScriptedFirmware::SetUp() {
  fs::create_directories(path("etc"));
  copy("board.toml");
  copy("team.toml");
}

void ScriptedFirmware::TearDown() {
  if (process_ > 0) stop_program(SIGTERM);
}

void ScriptedFirmware::copy(const std::string& name) const {
  fs::copy_file(fs::path(TOUCHLINE_MOCK_FOLDER) / name, saved(name), fs::copy_options::overwrite_existing);
}

void ScriptedFirmware::start_program() {
  const std::string board = saved("board.toml"), folder = path("state"), socket = path("socket");
  process_ = ::fork();
  ASSERT_GE(process_, 0);
  if (process_ == 0) {
    // Fonts are never freed, which the leak sanitizer would report.
    ::setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
    ::execl(TOUCHLINE_SETUP, "touchline-setup", "--board", board.c_str(), "--state", folder.c_str(), "--socket",
            socket.c_str(), nullptr);
    ::_exit(127);
  }
  connect();
}

void ScriptedFirmware::stop_program(int signal) {
  disconnect();
  ::kill(process_, signal);
  int status = 0;
  ASSERT_EQ(::waitpid(process_, &status, 0), process_);
  process_ = 0;
  if (signal == SIGTERM) {
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
}

void ScriptedFirmware::connect() {
  disconnect();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string socket_path = path("socket");
  ASSERT_LT(socket_path.size(), sizeof(address.sun_path));
  std::memcpy(address.sun_path, socket_path.c_str(), socket_path.size() + 1);
  // The program needs a moment to start; if it has ended, waiting does not help.
  for (;;) {
    hal::Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
      socket_ = std::move(socket);
      break;
    }
    ASSERT_EQ(::waitpid(process_, nullptr, WNOHANG), 0) << "touchline-setup has ended";
    ::usleep(10000);
  }
}

Message ScriptedFirmware::receive() {
  for (;;) {
    Result<std::optional<Message>> message = reader_.next();
    if (!message.ok()) ADD_FAILURE() << message.text();
    if (!message.ok()) return {};
    if (message.value()) return std::move(*message.value());
    std::array<char, 65536> part{};
    const ssize_t count = ::recv(socket_.get(), part.data(), part.size(), 0);
    if (count <= 0) {
      ADD_FAILURE() << "touchline-setup has closed the connection";
      return {};
    }
    reader_.append({part.data(), static_cast<std::size_t>(count)});
  }
}

void ScriptedFirmware::send_bytes(const std::string& bytes) const {
  ASSERT_EQ(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
}

void ScriptedFirmware::deliver() {
  if (!camera_error_.empty() || camera_.empty()) {
    send_bytes(framed({{"type", "frame"}, {"error", camera_.empty() ? "no camera" : camera_error_}}));
    return;
  }
  const hal::Picture& picture = camera_[delivered_++ % camera_.size()];
  const std::string bytes(picture.rgb8.begin(), picture.rgb8.end());
  send_bytes(framed({{"type", "frame"},
                     {"number", delivered_},
                     {"captured_s", 0.0},
                     {"format", "rgb24"},
                     {"width_px", picture.width_px},
                     {"height_px", picture.height_px}},
                    bytes));
}

void ScriptedFirmware::handle(const Message& message) {
  const std::string type = message.content.value("type", "");
  if (type == "answer") answers_.push_back(message.content);
  if (type == "binary") {
    // The header of the console's pictures: the id at byte 12, the PNG from byte 32 on.
    ASSERT_GE(message.bytes.size(), 32u);
    EXPECT_EQ(message.bytes.substr(0, 6), std::string("TLPC\x01\x02", 6));
    std::uint32_t id = 0;
    std::memcpy(&id, message.bytes.data() + 12, sizeof(id));
    pictures_.push_back({{{"id", id}}, message.bytes.substr(32)});
  }
  if (type == "setup" && message.content.contains("state")) state_ = message.content["state"];
  if (type == "setup" && message.content.contains("live")) live_ = message.content["live"];
  if (type == "frames" && delivers_) {
    for (int count = message.content["count"].get<int>(); count > 0; --count) deliver();
  }
  if (type == "use") {
    used_.push_back(message.content);
    if (loads_) answer_use();
  }
  if (type == "try") tries_.push_back(message.content);
  if (type == "test") tests_.push_back(message.content);
  if (type == "wheels") wheels_.push_back(message.content);
}

void ScriptedFirmware::answer_use(const std::string& error) {
  nlohmann::json answer{{"type", "used"}, {"to", used_.back()["request"]}, {"ok", error.empty()}};
  if (!error.empty()) answer["error"] = error;
  send_bytes(framed(answer));
}

void ScriptedFirmware::serve_until(const std::function<bool()>& is_enough) {
  while (!is_enough() && socket_.is_open() && !HasFailure()) handle(receive());
}

int ScriptedFirmware::send(const std::string& command, nlohmann::json members) {
  members.update({{"type", "setup"}, {"client", 7}, {"request", next_request_}, {"command", command}});
  send_bytes(framed(members));
  return next_request_++;
}

nlohmann::json ScriptedFirmware::answer_to(int request) {
  nlohmann::json found;
  serve_until([&] {
    const auto answer =
        std::find_if(answers_.begin(), answers_.end(), [&](const auto& one) { return one["to"] == request; });
    if (answer == answers_.end()) return false;
    found = *answer;
    return true;
  });
  return found;
}

nlohmann::json ScriptedFirmware::run(const std::string& command, nlohmann::json members) {
  return answer_to(send(command, std::move(members)));
}

nlohmann::json ScriptedFirmware::expect_ok(const std::string& command, nlohmann::json members) {
  const nlohmann::json answer = run(command, std::move(members));
  EXPECT_TRUE(answer.value("ok", false)) << command << ": " << answer.dump();
  return answer.value("result", nlohmann::json());
}

void ScriptedFirmware::expect_error(const std::string& command, nlohmann::json members, const std::string& text) {
  const nlohmann::json answer = run(command, std::move(members));
  EXPECT_FALSE(answer.value("ok", true)) << command << ": " << answer.dump();
  EXPECT_NE(answer.value("error", "").find(text), std::string::npos) << command << ": " << answer.dump();
}

const Message& ScriptedFirmware::picture(const nlohmann::json& id) {
  static const Message kNone{nlohmann::json::object(), ""};
  const auto found =
      std::find_if(pictures_.rbegin(), pictures_.rend(), [&](const Message& one) { return one.content["id"] == id; });
  if (found != pictures_.rend()) return *found;
  ADD_FAILURE() << "picture " << id << " did not arrive";
  return kNone;
}

}  // namespace touchline::setup
