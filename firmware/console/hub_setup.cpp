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
  const bool is_saved = !scene_.is_draft && scene_.is_calibrated && error.empty();
  // Robots that stood because of a draft start only when a person says so.
  if (is_saved && std::exchange(is_held_, false)) driving_.stop_after_setup();
  is_held_ = is_held_ || scene_.is_draft || !scene_.is_calibrated;
  for (Client& client : clients_) client.wants_hello = true;
  setup_.set_hello(setup_hello_text(scene_));
  if (order_) answer(*order_, error);
  order_.reset();
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
    if (order_) {
      reason = kLoadingFiles;
    } else if (!scene_.is_draft || !scene_.is_calibrated) {
      reason = "no calibrated draft is in use";
    } else if (driving_.is_stopped()) {
      reason = "robots are stopped: press Start first";
    }
    is_trying_ = *reason == '\0';
  } else {
    is_trying_ = false;
  }
  setup_.answer(order, reason, scene_.is_calibrated);
}

void Hub::end_try(const char* reason) {
  if (!std::exchange(is_trying_, false)) return;
  // This answer belongs to no request; it tells the page that robots no longer play with the draft.
  if (setup_.is_running()) setup_.answer({SetupOrder::Kind::kTry, 0, {}}, reason, scene_.is_calibrated);
}

Result<void> Hub::use(const SetupOrder& order) {
  if (!links_.use_files) return failure(ErrorCode::kUnsupported, "this program cannot use other files");
  if (order_) return failure(ErrorCode::kBusy, "%s", kLoadingFiles);
  if (order.kind == SetupOrder::Kind::kUseDraft) is_held_ = true;
  end_try("the files have changed");
  // From here on robots stand, even while the files are being read.
  order_ = order;
  update_setup_wish(hal::MonotonicClock::read());
  pass_on();
  files_.run([this, use = links_.use_files, draft = order.files]() -> FileThread::Finish {
    const auto used = std::make_shared<Result<FilesUse>>(failure(ErrorCode::kFull, "the board is out of memory"));
    try {
      *used = use(draft);
    } catch (const std::exception&) {
    }
    return [this, used] { end_use(*used); };
  });
  return {};
}

void Hub::end_use(const Result<FilesUse>& used) {
  // In the latter case begin_session() answers, or has answered already.
  if (!order_ || (used.ok() && used.value() == FilesUse::kInNextSession)) return;
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
  if (!setup_.is_running() || driving_.is_stopped()) end_try("a stop ended the try");
  const bool may_move = setup_.is_running() && scene_.is_draft && !order_ && (is_trying_ || driving_.is_driving(now));
  const SetupWish wish = !is_held_ ? SetupWish::kNone : may_move ? SetupWish::kPermit : SetupWish::kStand;
  if (std::exchange(wish_, wish) != wish) links_.loop.input.put(input_now());
}

ConsoleInput Hub::input_now() const {
  ConsoleInput input = driving_.input();
  input.setup = wish_;
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
