#include <algorithm>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>

#include "firmware/console/hub.h"

// Functions of the hub for the guided setup.
namespace touchline::console {
namespace {

constexpr char kLoadingFiles[] = "other files are being loaded";

}  // namespace

std::string setup_hello_text(const Scene& scene) {
  const nlohmann::json hello{{"type", "hello"},
                             {"protocol", 1},
                             {"version", scene.version},
                             {"board", scene.files.board},
                             {"venue", scene.files.venue},
                             {"team", scene.files.team},
                             {"using", word_of_files(scene)},
                             {"calibrated", scene.is_calibrated},
                             {"camera",
                              {{"width_px", scene.camera.width_px},
                               {"height_px", scene.camera.height_px},
                               {"rate_hz", scene.camera.rate_hz},
                               {"format", info_of(scene.camera.format).word}}}};
  return hello.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_setup_program(report::JsonWriter& json, bool is_running) {
  json.begin_object();
  json.key("type");
  json.string("setup_program");
  json.key("running");
  json.boolean(is_running);
  json.end_object();
}

void Hub::serve_setup(Instant now) {
  setup_.serve(now);
  while (const std::optional<SetupOrder> order = setup_.next_order()) obey(*order);
  serve_test(now);
  if (!setup_.wants_frame(now)) return;
  const Snapshot* const snapshot = has_picture(setup_.next_frame()) ? feed_.find(pictures_.number()) : nullptr;
  if (snapshot == nullptr) return pictures_.request(now);
  setup_.send_frame(*pictures_.frame(), snapshot->number, captured_unix_s(*snapshot, unix_time_), now);
}

void Hub::begin_session(Scene scene, const std::string& error) {
  scene_ = std::move(scene);
  pictures_.restart();
  feed_.set_frame_period(period_of_rate(scene_.camera.rate_hz));
  driving_.set_robots(own_robots(scene_));
  end_try("the loop has started anew");
  end_test("the loop has started anew");
  // The session of an order that is still pending will follow: until then, robots stand as the order wants it.
  const bool is_ordered = order_ && order_->number == scene_.order, is_pending = order_ && !is_ordered;
  const bool is_saved = !scene_.is_draft && scene_.is_calibrated && error.empty() && !is_pending;
  // Robots that stood because of a draft start when a person says so.
  if (is_saved && std::exchange(is_held_, false)) driving_.stop_after_setup();
  is_held_ = is_held_ || scene_.is_draft || !scene_.is_calibrated;
  for (Client& client : clients_) client.wants_hello = true;
  setup_.set_hello(setup_hello_text(scene_));
  if (is_ordered) answer(*std::exchange(order_, std::nullopt), error);
  if (!error.empty()) links_.print("console: setup: " + error);
  wish_ = is_held_ ? SetupWish::kStand : SetupWish::kNone;
  links_.loop.input.put(input_now());
}

void Hub::obey(const SetupOrder& order) {
  using Kind = SetupOrder::Kind;
  if (order.kind == Kind::kUseDraft || order.kind == Kind::kUseSaved) {
    const Result<void> used = use(order);
    if (used.ok()) return;  // the order is answered, or begin_session() will answer it
    setup_.answer(order, used.text(), scene_.is_calibrated);
    links_.print("console: setup: " + used.text());
    return;
  }
  const char* reason = "";
  if (order.kind == Kind::kTry) {
    reason = reason_to_stand();
    is_trying_ = *reason == '\0';
  } else if (order.kind == Kind::kTest) {
    reason = begin_test(order);
  } else if (order.kind == Kind::kEndTest) {
    forget_test();
  } else {
    is_trying_ = false;
  }
  setup_.answer(order, reason, scene_.is_calibrated);
}

void Hub::end_try(const char* reason) {
  if (!std::exchange(is_trying_, false)) return;
  // This answer belongs to no request; it tells the page that robots no longer play with the draft.
  if (setup_.is_running()) setup_.answer({SetupOrder::Kind::kTry, kUnknownId, 0, {}}, reason, scene_.is_calibrated);
}

const char* Hub::reason_to_stand() const {
  if (order_) return kLoadingFiles;
  if (!scene_.is_draft || !scene_.is_calibrated) return "no calibrated draft is in use";
  return driving_.is_stopped() ? "robots are stopped: press Start first" : "";
}

const char* Hub::begin_test(const SetupOrder& order) {
  if (const char* const reason = reason_to_stand(); *reason != '\0') return reason;
  if (is_trying_) return "robots play with the draft: end the try first";
  if (!driving_.driver()) return "nobody has control";
  const std::vector<RobotId>& robots = driving_.robots();
  if (std::find(robots.begin(), robots.end(), order.robot) == robots.end()) return "the team file has no such robot";
  forget_test();
  const Snapshot* const newest = feed_.newest();
  test_ = Test{order.robot, driving_.driver(), newest == nullptr ? 0 : newest->number + 1};
  links_.loop.input.put(input_now());
  return "";
}

void Hub::forget_test() {
  if (!test_) return;
  driving_.end_wheels(test_->robot);
  test_.reset();
  links_.loop.input.put(input_now());
}

void Hub::end_test(const char* reason) {
  if (!test_) return;
  forget_test();
  if (setup_.is_running()) setup_.answer({SetupOrder::Kind::kTest, kUnknownId, 0, {}}, reason, scene_.is_calibrated);
}

// The setup program gets each frame once. Its speeds count as long as a driver's, so the robot stands if it is late.
void Hub::serve_test(Instant now) {
  const std::optional<WheelSpeeds> wheels = setup_.take_wheels();
  if (!test_) return;
  if (wheels) static_cast<void>(driving_.drive_wheels(test_->robot, *wheels, now).ok());
  const Snapshot* const newest = feed_.newest();
  if (newest == nullptr) return;
  for (; test_->next <= newest->number; ++test_->next) {
    const Snapshot* const snapshot = feed_.find(test_->next);
    if (snapshot != nullptr && !setup_.send_step(*snapshot, test_->robot)) return;
  }
}

Result<void> Hub::use(const SetupOrder& order) {
  if (!links_.use_files) return failure(ErrorCode::kUnsupported, "this program cannot use other files");
  if (order_) return failure(ErrorCode::kBusy, "%s", kLoadingFiles);
  if (order.kind == SetupOrder::Kind::kUseDraft) is_held_ = true;
  end_try("the files have changed");
  end_test("the files have changed");
  // From here on robots stand, even while the files are being read.
  order_ = order;
  order_->number = ++last_order_;
  update_setup_wish(hal::MonotonicClock::read());
  pass_on();
  const auto job = [this, use = links_.use_files, draft = order.files, number = last_order_]() -> FileThread::Finish {
    const auto used = std::make_shared<Result<FilesUse>>(failure(ErrorCode::kFull, "the board is out of memory"));
    try {
      *used = use(draft, number);
    } catch (const std::exception&) {
    }
    return [this, number, used] { end_use(number, *used); };
  };
  try {
    files_.run(job);
  } catch (const std::exception& error) {  // there is no thread: the order must not stay open
    order_.reset();
    return failure(ErrorCode::kFull, "files cannot be loaded: %s", error.what());
  }
  return {};
}

void Hub::end_use(std::uint64_t number, const Result<FilesUse>& used) {
  // In this case begin_session() answers, or has answered already.
  if (!order_ || order_->number != number || (used.ok() && used.value() == FilesUse::kInNextSession)) return;
  answer(*std::exchange(order_, std::nullopt), used.text());
  if (!used.ok()) links_.print("console: setup: " + used.text());
}

void Hub::answer(const SetupOrder& order, const std::string& error) {
  setup_.answer(order, error, scene_.is_calibrated);
  const auto client =
      std::find_if(clients_.begin(), clients_.end(), [&](const Client& one) { return one.number == order.client; });
  if (client == clients_.end() || (order.to_client == 0 && error.empty())) return;
  client->answers.push_back({order.to_client, error});
}

Result<void> Hub::leave_setup(const Client& client, std::int64_t request) {
  TOUCHLINE_TRY(driving_.require_driver(client.number));
  if (!is_held_) return {};
  SetupOrder order;
  order.client = client.number;
  order.to_client = request;
  return use(order);
}

void Hub::update_setup_wish(Instant now) {
  if (!setup_.is_running() || driving_.is_stopped()) {
    end_try("a stop ended the try");
    end_test("robots were stopped");
  }
  if (test_ && test_->driver != driving_.driver()) end_test("whoever had control has left");
  const bool may_move = setup_.is_running() && scene_.is_draft && !order_ && (is_trying_ || driving_.is_driving(now));
  const SetupWish wish = !is_held_ ? SetupWish::kNone : may_move ? SetupWish::kPermit : SetupWish::kStand;
  if (std::exchange(wish_, wish) != wish) links_.loop.input.put(input_now());
}

ConsoleInput Hub::input_now() const {
  ConsoleInput input = driving_.input();
  input.setup = wish_;
  if (test_) input.tested = test_->robot;
  if (wish_ != SetupWish::kPermit || is_trying_) return input;
  // With a draft only one robot is driven; the others stand.
  const Instant now = hal::MonotonicClock::read();
  for (const RobotId id : driving_.robots()) {
    const bool is_driven = std::any_of(input.commands.begin(), input.commands.end(),
                                       [id](const ExternalCommand& command) { return command.id == id; });
    ExternalCommand stand;
    stand.id = id;
    stand.received = now;
    // cannot be full, because there are no more robots than commands
    if (!is_driven) static_cast<void>(input.commands.push_back(stand));
  }
  return input;
}

bool Hub::pass_to_setup(const Client& client, std::string_view text, const ClientMessage& message, Answer& answer) {
  answer.to = message.request.value_or(0);
  Result<void> passed = driving_.require_driver(client.number);
  if (passed.ok()) passed = setup_.pass_command(client, text, answer.to);
  if (!passed.ok()) answer.error = passed.text();
  return passed.ok();
}

Outgoing Hub::setup_message(Client& client) {
  if (std::exchange(client.wants_setup_program, false)) {
    return text_message([&](auto& json) { write_setup_program(json, setup_.is_running()); });
  }
  if (client.setup_state != nullptr) {
    parcel_ = std::exchange(client.setup_state, nullptr);
  } else if (!client.parcels.empty()) {
    parcel_ = std::move(client.parcels.front());
    client.parcels.pop_front();
  } else {
    return {};
  }
  return {std::span(parcel_->bytes).subspan(kMessagePrefix), parcel_->is_binary};
}

}  // namespace touchline::console
