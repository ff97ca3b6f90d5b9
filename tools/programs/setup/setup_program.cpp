#include "tools/programs/setup/setup_program.h"

#include <poll.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "tools/programs/setup/camera_frame.h"
#include "tools/programs/setup/camera_quality.h"
#include "tools/programs/setup/page_state.h"
#include "tools/programs/setup/saving.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

std::string type_of(const nlohmann::json& message) {
  return message.contains("type") && message.at("type").is_string() ? message.at("type").get_ref<const std::string&>()
                                                                    : std::string();
}

// Returns the header of a binary message of the console, for a picture with an id (docs/console-protocol.md).
std::string picture_header(std::uint32_t id, std::uint32_t width_px, std::uint32_t height_px) {
  constexpr std::size_t kPageHeaderBytes = 32;
  std::string out = "TLPC";
  const auto append = [&out](std::uint32_t value, unsigned bytes) {
    for (unsigned shift = 0; shift < 8 * bytes; shift += 8) out += static_cast<char>(value >> shift & 0xffu);
  };
  append(1, 1);  // version
  append(2, 1);  // kind
  append(width_px, 2);
  append(height_px, 2);
  append(0, 2);
  append(id, 4);
  out.resize(kPageHeaderBytes, '\0');
  return out;
}

}  // namespace

SetupProgram::SetupProgram(SetupOptions options, hal::TextOutput& output)
    : options_(std::move(options)), output_(output), draft_(options_.folder) {}

void SetupProgram::print(const std::string& text) { output_.print_error("touchline-setup: " + text + "\n"); }

Result<void> SetupProgram::open() {
  std::error_code error;
  fs::create_directories(options_.folder, error);
  if (error) {
    return failure(ErrorCode::kPermission, "%s: cannot be made: %s", options_.folder.c_str(), error.message().c_str());
  }
  const Result<std::vector<std::string>> finished = finish_saving(options_.folder + "/saving.json");
  if (!finished.ok()) print(finished.text());
  if (finished.ok()) {
    for (const std::string& path : finished.value()) {
      print(path +
            ": a save was interrupted, and somebody has changed this file since: it stays as it is; check whether it "
            "fits "
            "the others");
    }
  }
  TOUCHLINE_TRY(listener_.open(options_.socket));
  // Restrict access, because a client can change the files of the board.
  if (::chmod(options_.socket.c_str(), S_IRUSR | S_IWUSR) == 0) return {};
  return failure(ErrorCode::kPermission, "%s: its permissions cannot be set", options_.socket.c_str());
}

void SetupProgram::run(int signals) {
  for (;;) {
    std::array<pollfd, 4> files{{{signals, POLLIN, 0},
                                 {listener_.descriptor(), POLLIN, 0},
                                 {firmware_.descriptor(), POLLIN, 0},
                                 {worker_.is_running() ? worker_.link().descriptor() : -1, POLLIN, 0}}};
    if (firmware_.has_output()) files[2].events |= POLLOUT;
    if (::poll(files.data(), files.size(), wait_ms()) < 0) continue;
    if (files[0].revents != 0) return;
    if (files[3].revents != 0) receive_from_worker();
    if ((files[2].revents & POLLOUT) != 0) static_cast<void>(firmware_.flush().ok());
    if ((files[2].revents & ~POLLOUT) != 0 && firmware_.is_open()) receive_from_firmware();
    if (files[1].revents != 0) accept();
    check_time();
  }
}

void SetupProgram::accept() {
  hal::Descriptor descriptor = listener_.accept();
  if (!descriptor.is_open()) return;
  firmware_.close();
  firmware_ = MessageLink(std::move(descriptor));
  use_runs_ = use_is_stale_ = trying_ = try_waits_ = false;
  // A restarted firmware runs with the saved files and has forgotten a request for a frame.
  if (running_ && running_->waits_for_frame) request_frames();
  if (running_ && running_->drives) end_job("the connection to the firmware was lost");
  if (draft_.is_open() && uses_draft_) use(true);
  send_state();
}

void SetupProgram::receive_from_firmware() {
  const Result<void> received = firmware_.receive();
  for (;;) {
    Result<std::optional<Message>> message = firmware_.next();
    if (!message.ok()) print("the firmware's message: " + message.text());
    if (!message.ok() || !message.value()) break;
    handle(*message.value());
  }
  if (!received.ok()) firmware_.close();
}

void SetupProgram::receive_from_worker() {
  const Result<void> received = worker_.link().receive();
  while (worker_.is_running()) {
    Result<std::optional<Message>> message = worker_.link().next();
    if (!message.ok() || !message.value()) break;
    handle_work(std::move(*message.value()));
  }
  if (!received.ok() && worker_.is_running()) end_job(worker_.finish());
}

void SetupProgram::handle(const Message& message) {
  const std::string type = type_of(message.content);
  if (type == "setup") handle_command(message.content);
  if (type == "frame") handle_frame(message);
  if (type == "step") drive_robot(message.content);
  if (type == "tested") handle_tested(message.content);
  if (type == "tried") {
    // This arrives without a request, too, if a stop or changed files have ended the try.
    trying_ = message.content.contains("ok") && message.content.at("ok") == true && trying_;
    send_state();
  }
  if (type == "used") {
    const Result<std::string> error = Arguments(message.content).text("error", "");
    preview_ = {{"source", uses_draft_ ? "draft" : "saved"}, {"ok", error.ok() && error.value().empty()}};
    preview_["error"] = error.ok() ? error.value() : "";
    use_runs_ = false;
    if (use_is_stale_) use(uses_draft_);
    ask_to_drive();
    if (!use_runs_ && std::exchange(try_waits_, false)) {
      trying_ = trying_ && preview_["ok"] == true;
      if (trying_) ask_to_try();
    }
    send_state();
  }
  if (type == "watch" && draft_.is_open() && message.content.contains("client")) {
    for (const auto& [id, picture] : draft_.now().pictures) send_picture(id, picture, message.content.at("client"));
  }
}

void SetupProgram::handle_command(const nlohmann::json& message) {
  asker_ = {message.contains("client") ? message.at("client") : nlohmann::json(),
            message.contains("request") ? message.at("request") : nlohmann::json(0)};
  answered_ = false;
  const Arguments arguments(message);
  Result<nlohmann::json> result = nlohmann::json(nullptr);
  const Result<std::string> name = arguments.text("command");
  const auto& known = commands();
  const auto command = std::find_if(known.begin(), known.end(),
                                    [&](const Command& one) { return name.ok() && name.value() == one.name; });
  if (!name.ok()) {
    result = name.error();
  } else if (command == known.end()) {
    result = failure(ErrorCode::kNotFound, "the command %.40s is unknown", name.value().c_str());
  } else if (command->needs_draft && !draft_.is_open()) {
    result = Error{ErrorCode::kNotFound, "there is no draft: begin first"};
  } else if (running_ && !command->while_busy) {
    result = failure(ErrorCode::kDeviceBusy, "%s is still running: wait, or cancel it", running_->job.command.c_str());
  } else {
    result = (this->*command->handler)(arguments);
  }
  if (!answered_) answer(asker_, result);
}

void SetupProgram::answer(const Asker& asker, const Result<nlohmann::json>& result) {
  if (asker.request == 0) return;
  nlohmann::json content = {{"type", "answer"},
                            {"client", asker.client},
                            {"to", asker.request},
                            {"ok", result.ok()},
                            {"error", result.text()}};
  if (result.ok() && !result.value().is_null()) content["result"] = result.value();
  send(content);
}

void SetupProgram::send(const nlohmann::json& content, std::string_view bytes) {
  if (!firmware_.is_open()) return;
  const Result<void> sent = firmware_.send(content, bytes);
  if (!sent.ok()) print("the firmware: " + sent.text());
}

void SetupProgram::send_state() {
  nlohmann::json busy;
  if (running_) {
    busy = {{"command", running_->job.command}, {"text", running_->text}, {"progress", running_->progress}};
    if (!running_->exchange.is_null()) busy["exchange"] = running_->exchange;
  }
  nlohmann::json state = {{"open", draft_.is_open()},
                          {"board", options_.board},
                          {"busy", busy},
                          {"error", error_},
                          {"preview", preview_},
                          {"trying", trying_},
                          {"changed_files", nlohmann::json::array()},
                          {"undo", draft_.undo_names()},
                          {"redo", draft_.redo_names()},
                          {"steps", nlohmann::json::object()}};
  if (draft_.is_open()) {
    state["changed_files"] = changed_files(draft_.saved(), draft_.now().files);
    state["steps"] = steps_of(draft_.now(), draft_.files_folder());
    if (camera_.is_object()) state["steps"]["camera"].update(camera_);
  }
  send({{"type", "setup"}, {"state", state}});
}

void SetupProgram::send_picture(std::uint32_t id, const ShownPicture& picture, const nlohmann::json& client) {
  nlohmann::json content = {{"type", "binary"}};
  if (!client.is_null()) content["client"] = client;
  send(content, picture_header(id, picture.width_px, picture.height_px) + *picture.bytes);
}

void SetupProgram::use(bool draft) {
  uses_draft_ = draft;
  // The firmware rejects an order while it loads the files of an earlier one; then only the newest order is repeated.
  use_is_stale_ = use_runs_;
  if (use_runs_ || !firmware_.is_open()) return;
  use_runs_ = true;
  // Use absolute paths, because the firmware may run in another folder.
  const auto absolute = [](const fs::path& path) {
    std::error_code error;
    return fs::absolute(path, error).string();
  };
  const fs::path folder = draft ? fs::path(draft_.files_folder()) : fs::path(options_.board).parent_path();
  const auto named = [&](const std::string& name) { return absolute(folder / name); };
  nlohmann::json content = {{"type", "use"}, {"request", ++use_request_}, {"source", draft ? "draft" : "saved"}};
  content["board"] = draft ? named(draft_.now().files.board) : absolute(options_.board);
  if (draft) {
    content["venue"] = named(draft_.now().files.venue);
    content["team"] = named(draft_.now().files.team);
  }
  send(content);
}

void SetupProgram::ask_to_try() { send({{"type", "try"}, {"request", ++use_request_}, {"on", trying_}}); }

void SetupProgram::answer_camera(const Result<CameraFrame>& frame) {
  if (frame.ok() && draft_.is_open()) {
    camera_ = touchline::setup::camera_quality(frame.value()->frame(), draft_.now().files, draft_.files_folder());
  }
  for (const Asker& asker : std::exchange(measure_camera_, {})) {
    answer(asker, frame.ok() ? Result<nlohmann::json>(camera_) : Result<nlohmann::json>(frame.error()));
  }
  send_state();
}

void SetupProgram::handle_frame(const Message& message) {
  if (!measure_camera_.empty()) answer_camera(camera_frame_of(message));
  if (!running_ || !running_->waits_for_frame) return;
  const Result<CameraFrame> frame = camera_frame_of(message);
  if (!frame.ok()) {
    end_job("the camera's picture: " + frame.text());
    return;
  }
  running_->waits_for_frame = false;
  const Job& job = running_->job;
  ++running_->frame_number;
  if (!job.take_frame) {
    running_->frames.push_back(frame.value());
  } else if (const Result<void> taken = job.take_frame(frame.value()->frame()); !taken.ok()) {
    end_job(taken.text());
    return;
  }
  if (running_->frame_number >= job.frame_count) {
    begin_work();
  } else if (job.frame_interval_s > 0) {
    running_->next_frame =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(job.frame_interval_s));
    running_->progress = static_cast<double>(running_->frame_number) / static_cast<double>(job.frame_count);
    send_state();
  } else {
    request_frames();
  }
}

}  // namespace touchline::setup
