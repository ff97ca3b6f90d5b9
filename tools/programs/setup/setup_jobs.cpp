#include <algorithm>
#include <filesystem>
#include <utility>

#include "hal/files/input_file.h"
#include "tools/programs/setup/setup_program.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

// Allows for a camera that is being reopened, which takes some seconds.
constexpr std::chrono::seconds kFrameTimeout{20};
// A state has all values of the files, and a person sees no faster changes.
constexpr std::chrono::milliseconds kStatePeriod{200};

}  // namespace

Result<nlohmann::json> SetupProgram::start(Job job) {
  running_.emplace();
  running_->asker = asker_;
  running_->text = job.text;
  running_->state = draft_.now();
  running_->job = std::move(job);
  answered_ = true;
  if (running_->job.drive) {
    begin_driving();
  } else if (running_->job.frame_count > 0) {
    request_frames();
  } else {
    begin_work();
  }
  if (running_) send_state();
  return nlohmann::json(nullptr);
}

// Requests one frame at a time: the loop copies a picture only on request, and the connection may be lost between two
// frames.
void SetupProgram::request_frames() {
  running_->waits_for_frame = true;
  running_->next_frame = {};
  running_->give_up = Clock::now() + kFrameTimeout;
  send({{"type", "frames"}, {"count", 1}});
}

void SetupProgram::begin_driving() {
  if (!firmware_.is_open()) return end_job("the firmware is not connected, so no robot can be driven");
  running_->drives = true;
  running_->give_up = Clock::now() + kFrameTimeout;
  ask_to_drive();
}

// While the firmware loads the draft's newest files, it drives no robot.
void SetupProgram::ask_to_drive() {
  if (!running_ || !running_->drives || use_runs_) return;
  running_->test_request = ++use_request_;
  running_->is_tested = false;
  send({{"type", "test"}, {"request", use_request_}, {"robot", running_->job.robot}});
}

// The firmware stops the robot by itself, too, when no speeds arrive any more.
void SetupProgram::end_driving() {
  if (!running_ || !std::exchange(running_->drives, false)) return;
  send({{"type", "test"}, {"request", ++use_request_}, {"robot", nullptr}});
}

// 0 answers no request: the firmware itself has ended the test that runs.
void SetupProgram::handle_tested(const nlohmann::json& answer) {
  if (!running_ || !running_->drives) return;
  const std::int64_t to = answer.value("to", std::int64_t{-1});
  const bool is_ok = answer.value("ok", false);
  if (to == running_->test_request) running_->is_tested = is_ok;
  if (is_ok || (to != running_->test_request && (to != 0 || !running_->is_tested))) return;
  end_job("robot " + std::to_string(int{running_->job.robot}) +
          " stands: " + answer.value("error", std::string("the firmware refuses to drive it")));
}

void SetupProgram::drive_robot(const nlohmann::json& message) {
  if (!running_ || !running_->drives) return;
  running_->give_up = Clock::now() + kFrameTimeout;
  const Result<TestedFrame> frame = tested_frame_of(message);
  const Result<TestOrder> order = frame.ok() ? running_->job.drive(frame.value()) : frame.error();
  if (!order.ok()) return end_job(order.text());
  const TestOrder& wanted = order.value();
  if (!wanted.exchange.is_null()) running_->exchange = wanted.exchange;
  if (wanted.progress >= 0) running_->progress = wanted.progress;
  if (!wanted.text.empty()) running_->text = wanted.text;
  if (wanted.is_done) {
    running_->result = running_->exchange;
    end_driving();
    begin_work();
    return;
  }
  send({{"type", "wheels"}, {"left_mps", wanted.wheels.left_mps}, {"right_mps", wanted.wheels.right_mps}});
  if (Clock::now() - shown_ < kStatePeriod) return;
  shown_ = Clock::now();
  send_state();
}

void SetupProgram::begin_work() {
  JobInput input{options_.folder + "/work", running_->state, std::move(running_->frames)};
  std::error_code error;
  fs::remove_all(input.folder, error);
  Result<void> done = write_folder(running_->state.files, input.folder);
  if (running_->job.keeps_frames) {
    for (const CameraFrame& frame : input.frames) running_->state.color_frames.push_back(frame);
    input.state.color_frames = running_->state.color_frames;
  }
  if (done.ok()) {
    done = worker_.start([work = running_->job.work, &input](const Worker::Reporter& reporter) {
      return work(input, JobOutput(reporter));
    });
  }
  if (!done.ok()) end_job(done.text());
}

void SetupProgram::handle_work(Message message) {
  const nlohmann::json& content = message.content;
  const std::string type = content.at("type").get_ref<const std::string&>();
  DraftState& state = running_->state;
  const std::string& step = running_->job.step;
  if (type == "progress") {
    running_->text = content.at("text").get_ref<const std::string&>();
    running_->progress = content.at("progress");
    send_state();
  } else if (type == "measured") {
    state.measured[step] = content.at("value");
    for (auto one = state.pictures.begin(); one != state.pictures.end();) {
      one = one->second.owner == step ? state.pictures.erase(one) : std::next(one);
    }
  } else if (type == "result") {
    running_->result = content.at("value");
  } else if (type == "picture") {
    const std::uint32_t id = next_picture_++;
    const std::string member = content.at("member").get_ref<const std::string&>();
    const ShownPicture picture{content.at("width_px").get<std::uint32_t>(),
                               content.at("height_px").get<std::uint32_t>(),
                               std::make_shared<const std::string>(std::move(message.bytes)),
                               // The pictures of robots and ball are kept when the colors are learned again.
                               running_->job.keeps_frames && member == "pictures" ? step + ".pictures" : step};
    const bool changes = !running_->job.undo_name.empty();
    nlohmann::json& owner = changes ? state.measured[step] : running_->result;
    if (content.at("list").get<bool>()) {
      owner[member].push_back(id);
    } else {
      owner[member] = id;
    }
    if (changes) state.pictures[id] = picture;
    send_picture(id, picture, nullptr);
  } else if (type == "done") {
    const std::string error = content.at("error").get_ref<const std::string&>();
    const std::string end = worker_.finish();
    end_job(error.empty() ? end : error);
  }
}

void SetupProgram::end_job(const std::string& error) {
  end_driving();
  RunningJob ended = std::move(*running_);
  running_.reset();
  worker_.cancel();
  Result<nlohmann::json> result = ended.result;
  if (!error.empty()) {
    result = Error{ErrorCode::kInconsistent, error};
  } else if (!ended.job.undo_name.empty()) {
    std::map<std::string, FileContent> content;
    Result<void> read;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(options_.folder + "/work", failed)) {
      const std::string name = entry.path().filename().string();
      if (!is_file_name(name)) continue;
      Result<FileContent> one = read_setup_file(entry.path().string());
      if (one.ok()) {
        content[name] = std::move(one).value();
      } else {
        read = std::move(one).error();
      }
    }
    Result<SetupFiles> files = read.ok() ? setup_of(ended.state.files.board, content) : std::move(read).error();
    Result<void> kept = files.ok() ? keep_saved_pictures(draft_.saved(), files.value()) : files.error();
    if (kept.ok()) {
      ended.state.name = ended.job.undo_name;
      ended.state.files = std::move(files).value();
      Result<nlohmann::json> changed = change(std::move(ended.state));
      if (!changed.ok()) result = std::move(changed).error();
    } else {
      result = std::move(kept).error();
    }
  }
  send_state();
  answer(ended.asker, result);
}

int SetupProgram::wait_ms() const {
  if (!running_ || worker_.is_running()) return -1;
  const bool waits = running_->waits_for_frame || running_->drives;
  const Clock::time_point until = waits ? running_->give_up : running_->next_frame;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  return static_cast<int>(std::clamp<long>(static_cast<long>(left), 0, 60000));
}

void SetupProgram::check_time() {
  if (!running_ || worker_.is_running()) return;
  if (running_->drives) {
    if (Clock::now() >= running_->give_up) end_job("no picture came from the camera within 20 s");
    return;
  }
  if (running_->waits_for_frame && Clock::now() >= running_->give_up) {
    send({{"type", "frames"}, {"count", 0}});
    end_job(firmware_.is_open() ? "no picture came from the camera within 20 s"
                                : "the firmware is not connected, so there is no picture");
  } else if (!running_->waits_for_frame && Clock::now() >= running_->next_frame) {
    request_frames();
  }
}

}  // namespace touchline::setup
