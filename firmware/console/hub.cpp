#include "firmware/console/hub.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <tuple>

#include "firmware/console/picture_scaler.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

// Initial size of the text buffer. A state of 22 robots has 12 KB, a projection of the largest field 60 KB.
constexpr std::size_t kFirstTextBytes = std::size_t{64} * 1024;
constexpr double kDefaultStateHz = 15.0;
// Age at which a report of halts is no longer trusted. The loop reports once a second, also without frames.
constexpr Duration kLoopSilence = 2500ms;

}  // namespace

std::vector<RobotId> own_robots(const Scene& scene) {
  std::vector<RobotId> ids;
  for (const RobotMarking& robot : scene.configuration->pipeline.marker.teams[0].robots) ids.push_back(robot.id);
  return ids;
}

Duration period_of_rate(double rate_hz) { return rate_hz > 0.0 ? from_seconds(1.0 / rate_hz) : Duration::zero(); }

Hub::Hub(const HubLinks& links, Scene scene, const HubSettings& settings)
    : links_(links),
      scene_(std::move(scene)),
      picture_period_(period_of_rate(settings.picture_rate_hz)),
      feed_(links.snapshots, period_of_rate(scene_.camera.rate_hz)),
      pictures_(links.pictures, picture_period_),
      driving_(own_robots(scene_)),
      session_name_(std::to_string(unix_time_.to_unix(hal::MonotonicClock::read()).count())),
      setup_(settings.setup_socket, clients_, links.print, files_),
      text_(kMessagePrefix + kFirstTextBytes) {
  setup_.set_hello(setup_hello_text(scene_));
  is_held_ = scene_.is_draft || !scene_.is_calibrated;
}

void Hub::tick(Instant now) {
  files_.finish();
  recordings_thread_.finish();
  pictures_.poll();
  feed_.read();
  read_loop(now);
  update_setup_wish(now);
  pass_on();
  if (now >= next_second_) {
    next_second_ = std::max(next_second_ + 1s, now);
    unix_time_ = hal::measure_unix_time_offset();
    feed_.next_second();
    monitor_.measure(now);
    for (Client& client : clients_) client.wants_status = true;
  }
  read_reports(now);
  const std::optional<RecordingStatus> recording = links_.recordings ? links_.recordings->status() : std::nullopt;
  if (std::exchange(is_recording_, recording && recording->is_on) != is_recording_) {
    for (Client& client : clients_) client.wants_status = true;
  }
  if (!pictures_.error().empty() && !std::exchange(is_picture_failure_reported_, true)) {
    links_.print("console: no pictures: " + pictures_.error());
  }
  expire_probes(now);
  bool is_wanted = false, with_findings = false;
  for (const Client& client : clients_) {
    const bool lacks_picture = is_picture_due(client, now) && !has_fresh_picture(client);
    const bool lacks_probe = !client.probes.empty() && !has_probe_answer(client);
    is_wanted = is_wanted || lacks_picture || lacks_probe;
    with_findings =
        with_findings || !client.probes.empty() || (client.picture_period > Duration::zero() && client.findings.any());
  }
  if (is_wanted) pictures_.request(now, with_findings);
  serve_setup(now);
}

void Hub::read_loop(Instant now) {
  const bool is_held = links_.loop.is_held.load(std::memory_order_acquire);
  const bool has_changed = driving_.set_held(links_.loop.held_number.load(std::memory_order_acquire), is_held);
  if (has_changed && is_held && driving_.is_silent(now)) {
    links_.print("console: robots are stopped, because the driver (client " + std::to_string(*driving_.driver()) +
                 ") was silent for a second");
  }
}

void Hub::read_reports(Instant now) {
  const std::uint64_t count = links_.reports.count();
  if (count == reports_read_) return;
  reports_read_ = count;
  heard_from_loop_ = now;
  const StatusReport before = std::exchange(report_, links_.reports.get());
  if (report_.halt == before.halt && report_.stop_number == before.stop_number) return;
  // Without frames, clients learn of the change only from the status.
  for (Client& client : clients_) client.wants_status = true;
}

Outgoing Hub::status_message(Instant now) {
  const bool is_known = reports_read_ > 0 && now - heard_from_loop_ <= kLoopSilence;
  return text_message([&](auto& json) {
    write_status(json, scene_, feed_, report_, is_known ? std::optional(report_.halt) : std::nullopt,
                 driving_.is_stopped(), monitor_.status(), clients(), unix_s(now),
                 links_.recordings ? links_.recordings->status() : std::nullopt);
  });
}

void Hub::pass_on() {
  if (driving_.take_change()) links_.loop.input.put(input_now());
}

void Hub::announce_driver() {
  for (Client& client : clients_) client.wants_driver = true;
  setup_.tell_driver(driving_.driver());
}

std::size_t Hub::count_clients(bool stop_lines) const {
  return static_cast<std::size_t>(std::count_if(
      clients_.begin(), clients_.end(), [=](const Client& client) { return client.is_stop_line == stop_lines; }));
}

const Client* Hub::surplus_stop_line() const {
  if (count_clients(true) < kMaxClients) return nullptr;
  const auto silent = std::min_element(clients_.begin(), clients_.end(), [](const Client& a, const Client& b) {
    return std::tuple(!a.is_stop_line, a.heard) < std::tuple(!b.is_stop_line, b.heard);
  });
  return &*silent;
}

Client* Hub::connect(Instant now, ClientProtocol protocol, bool has_token) {
  const bool is_stop_line = protocol == ClientProtocol::kStop;
  const std::size_t places = kMaxClients + (has_token && !is_stop_line ? kPlacesForToken : 0);
  if (count_clients(is_stop_line) >= places) return nullptr;
  Client& client = clients_.emplace_back(is_stop_line ? ++last_stop_line_ : ++last_number_);
  client.heard = now;
  client.is_stop_line = is_stop_line;
  if (is_stop_line) return &client;
  if (protocol == ClientProtocol::kFoxglove) {
    client.foxglove = std::make_unique<FoxgloveClient>();
    return &client;
  }
  client.state_period = period_of_rate(kDefaultStateHz);
  client.next_state = now;
  return &client;
}

void Hub::disconnect(Client& client) {
  const ClientNumber number = client.number;
  const bool was_driver = driving_.driver() == number;
  setup_.forget(number);
  clients_.remove_if([number](const Client& other) { return other.number == number; });
  if (driving_.leave(number)) {
    links_.print("console: robots are stopped, because the driver (client " + std::to_string(number) + ") has left");
  }
  if (was_driver) announce_driver();
  pass_on();
}

bool Hub::receive(Client& client, std::string_view text, Instant arrived, Instant now) {
  client.heard = arrived;
  if (!client.limit.pass(now)) return false;
  if (client.foxglove != nullptr) return receive_foxglove(client, text, now);
  driving_.hear(client.number, arrived);
  const Result<ClientMessage> message = parse_client_message(text);
  // An error is answered even if the request has no number, because the client would otherwise not learn of it.
  Answer answer;
  bool is_answered = true;
  if (message.ok() && client.is_stop_line && message.value().kind != ClientMessage::Kind::kStop &&
      message.value().kind != ClientMessage::Kind::kPing) {
    answer = {message.value().request.value_or(0), "this connection is for \"stop\" and \"ping\" only"};
  } else if (message.ok() && message.value().kind == ClientMessage::Kind::kSetup) {
    is_answered = !pass_to_setup(client, text, message.value(), answer);
  } else if (message.ok()) {
    const Result<void> obeyed = obey(client, message.value(), arrived, now);
    const bool is_loading = message.value().kind == ClientMessage::Kind::kUseSaved && order_.has_value();
    const bool is_deleting = message.value().kind == ClientMessage::Kind::kRecording &&
                             message.value().recording == ClientMessage::RecordingWish::kDelete;
    const bool is_answered_later = message.value().kind == ClientMessage::Kind::kProbe || is_loading || is_deleting;
    is_answered = (message.value().request.has_value() && !is_answered_later) || !obeyed.ok();
    answer.to = message.value().request.value_or(0);
    if (!obeyed.ok()) answer.error = obeyed.text();
  } else {
    answer.error = message.text();
  }
  update_setup_wish(now);
  pass_on();
  if (!is_answered) return true;
  client.answers.push_back(std::move(answer));
  return client.answers.size() <= kMaxWaitingAnswers;
}

Result<void> Hub::obey(Client& client, const ClientMessage& message, Instant arrived, Instant now) {
  using Kind = ClientMessage::Kind;
  const std::string who = client.is_stop_line ? "a page" : "client " + std::to_string(client.number);
  switch (message.kind) {
    case Kind::kWatch:
      watch(client, message, now);
      return {};
    case Kind::kSeen:
      client.link.seen(message.number);
      return {};
    case Kind::kPing:
      return {};
    case Kind::kStop:
      if (!driving_.input().stop) links_.print("console: " + who + " stopped the robots");
      driving_.stop();
      return {};
    case Kind::kStart: {
      if (!message.stop_number) {
        return failure(ErrorCode::kInconsistent,
                       "\"stop_number\" is missing: a start must name the stop that it ends, which the newest state or "
                       "status tells; reload the page");
      }
      read_loop(now);
      const bool was_stopped = driving_.is_stopped();
      TOUCHLINE_TRY(driving_.start(client.number, *message.stop_number));
      if (was_stopped) links_.print("console: " + who + " started the robots");
      return {};
    }
    case Kind::kTake:
      if (driving_.driver() != client.number) links_.print("console: " + who + " drives");
      driving_.take(client.number, arrived);
      announce_driver();
      return {};
    case Kind::kRelease:
      TOUCHLINE_TRY(driving_.release(client.number));
      announce_driver();
      return {};
    case Kind::kDrive:
      if (message.gives_back) return driving_.give_back(client.number, message.id);
      if (test_)
        return failure(ErrorCode::kBusy, "the setup program drives robot %d: wait, or cancel it", int{test_->robot});
      return driving_.drive(client.number, message.id, message.twist, arrived);
    case Kind::kSetup:  // handled in pass_to_setup()
      return {};
    case Kind::kUseSaved:
      return leave_setup(client, message.request.value_or(0));
    case Kind::kProbe:
      return accept_probe(client, message, now);
    case Kind::kScore:
      TOUCHLINE_TRY(driving_.require_driver(client.number));
      told_score_ = message.score;
      return {};
    case Kind::kMove:
    case Kind::kArena:
      TOUCHLINE_TRY(driving_.require_driver(client.number));
      return links_.arena != nullptr ? links_.arena->control(message.arena) : ArenaObjects().control(message.arena);
    case Kind::kRecording:
      TOUCHLINE_TRY(driving_.require_driver(client.number));
      return control_recording(client, message);
    case Kind::kAdaptation:
      return change_adaptation(client, message.adaptation);
  }
  return {};
}

void Hub::watch(Client& client, const ClientMessage& message, Instant now) {
  setup_.watch(client, message.watches_setup);
  client.state_period = period_of_rate(message.state_hz);
  client.picture_period =
      std::max(period_of_rate(message.picture_hz), message.picture_hz > 0.0 ? picture_period_ : Duration::zero());
  client.picture_width_px = message.picture_width_px;
  client.next_state = client.next_picture = now;
  client.picture_follows.reset();
  client.findings = message.findings;
  const int wanted = client.picture_width_px > 0 ? client.picture_width_px : scene_.camera.width_px;
  const int full = scene_.camera.width_px;
  client.link.set(wanted > 0 ? std::max(1, (full + wanted - 1) / wanted) : 1, client.picture_period);
}

// Turns the wanted mode into requests: each request toggles between two modes.
Result<void> Hub::change_adaptation(const Client& client, AdaptationMode wanted) {
  TOUCHLINE_TRY(driving_.require_driver(client.number));
  if (links_.adaptation == nullptr) return failure(ErrorCode::kUnsupported, "this program has no adaptation");
  const AdaptationMode mode = report_.adaptation;
  if (mode == wanted) return {};
  const AdaptationMode exchanged = wanted == AdaptationMode::kFollow ? mode : wanted;
  std::atomic<std::uint32_t>& request =
      exchanged == AdaptationMode::kFrozen ? links_.adaptation->freeze : links_.adaptation->reset;
  request.fetch_add(1, std::memory_order_relaxed);
  report_.adaptation = wanted;
  return {};
}

bool Hub::is_watched() const {
  return test_ || setup_.is_busy() || std::any_of(clients_.begin(), clients_.end(), [](const Client& client) {
           return client.state_period > Duration::zero() || client.picture_period > Duration::zero() ||
                  !client.probes.empty();
         });
}

bool Hub::is_picture_due(const Client& client, Instant now) const {
  // Only clients of our own protocol say which pictures they have seen.
  const bool may_send =
      client.foxglove != nullptr ? client.link.on_the_way() < LinkControl::kMaxUnacknowledged : client.link.may_send();
  return client.picture_period > Duration::zero() && now >= client.next_picture && may_send;
}

// A picture older than the last state sent would make the overlays jump back.
bool Hub::has_fresh_picture(const Client& client) const {
  return pictures_.frame() != nullptr && pictures_.number() >= client.pictures_until &&
         pictures_.number() + 1 >= client.states_until && feed_.find(pictures_.number()) != nullptr;
}

bool Hub::is_state_due(const Client& client, Instant now) const {
  const Snapshot* const newest = feed_.newest();
  return client.state_period > Duration::zero() && newest != nullptr && newest->number >= client.states_until &&
         now >= client.next_state;
}

bool Hub::has_message(const Client& client, Instant now) const {
  if (client.foxglove != nullptr) return has_foxglove_message(client, now);
  if (client.is_stop_line) return !client.answers.empty();
  return client.wants_hello || client.wants_driver || client.wants_status || !client.answers.empty() ||
         client.wants_setup_program || client.setup_state != nullptr || !client.parcels.empty() ||
         links_.reports.events.after(client.last_event).has_value() || is_state_due(client, now) ||
         has_probe_answer(client) || (is_picture_due(client, now) && has_fresh_picture(client));
}

Outgoing Hub::next_message(Client& client, Instant now) {
  if (client.foxglove != nullptr) return next_foxglove_message(client, now);
  if (client.is_stop_line && client.answers.empty()) return {};
  if (!client.is_stop_line && std::exchange(client.wants_hello, false)) {
    return text_message(
        [&](auto& json) { write_hello(json, scene_, setup_.is_running(), client.number, unix_s(now)); });
  }
  if (!client.answers.empty()) {
    const Answer answer = std::move(client.answers.front());
    client.answers.pop_front();
    return text_message([&](auto& json) { write_answer(json, answer); });
  }
  if (std::exchange(client.wants_driver, false)) {
    return text_message([&](auto& json) { write_driver(json, driving_.driver(), client.number); });
  }
  if (const Outgoing message = setup_message(client); !message.bytes.empty()) return message;
  if (const std::optional<Event> event = links_.reports.events.after(client.last_event)) {
    client.last_event = event->number;
    return text_message([&](auto& json) { write_event(json, *event); });
  }
  if (std::exchange(client.wants_status, false)) return status_message(now);
  if (has_probe_answer(client)) return probe_message(client);
  const bool is_picture_next = is_picture_due(client, now) && has_fresh_picture(client);
  if (is_picture_next && client.picture_follows == pictures_.number()) {
    const Outgoing findings = findings_message(client);
    return findings.bytes.empty() ? picture_message(client, now) : findings;
  }
  if (is_picture_next) {
    client.picture_follows = pictures_.number();
    client.findings_left = pictures_.findings() != nullptr ? client.findings : WatchedFindings();
    client.findings_bytes = 0;
    advance(client.next_state, client.state_period, now);
    return state_message(client, *feed_.find(pictures_.number()));
  }
  client.picture_follows.reset();
  if (!is_state_due(client, now)) return {};
  advance(client.next_state, client.state_period, now);
  return state_message(client, *feed_.newest());
}

Outgoing Hub::state_message(Client& client, const Snapshot& snapshot) {
  client.states_until = snapshot.number + 1;
  return text_message(
      [&](auto& json) { write_state(json, scene_, snapshot, driving_.input(), unix_time_, told_score_); });
}

Outgoing Hub::picture_message(Client& client, Instant now) {
  client.picture_follows.reset();
  advance(client.next_picture, client.picture_period, now);
  client.pictures_until = pictures_.number() + 1;
  const PictureLevel level = client.link.level();
  const std::span<std::byte> jpeg = pictures_.jpeg(level);
  const Frame* const frame = pictures_.frame();
  if (jpeg.empty() || frame == nullptr || feed_.find(pictures_.number()) == nullptr) return {};
  put_header(jpeg.data() - kPictureHeaderBytes, *frame, kCameraKind, scaled(frame->width_px, level.divisor),
             scaled(frame->height_px, level.divisor), 0);
  const std::uint64_t end = client.written + kPictureHeaderBytes + jpeg.size();
  client.link.sent(pictures_.number(), jpeg.size() + client.findings_bytes, end, now);
  return {{jpeg.data() - kPictureHeaderBytes, jpeg.size() + kPictureHeaderBytes}, true};
}

// Writes the header of a binary message that belongs to the current picture.
void Hub::put_header(std::byte* to, const Frame& frame, std::uint8_t kind, std::uint16_t width, std::uint16_t height,
                     std::uint32_t special) const {
  const Snapshot* const snapshot = feed_.find(pictures_.number());
  put_little_endian(to, kPictureMagic);
  put_little_endian(to, std::uint8_t{1});  // version of the header
  put_little_endian(to, kind);
  put_little_endian(to, width);
  put_little_endian(to, height);
  put_little_endian(to, frame.width_px);
  put_little_endian(to, special);
  put_little_endian(to, pictures_.number());
  const double captured_s = snapshot != nullptr ? captured_unix_s(*snapshot, unix_time_) : 0.0;
  put_little_endian(to, static_cast<std::uint64_t>(captured_s * 1e6));
}

std::span<std::byte> Hub::current_jpeg(std::uint64_t from) {
  if (!has_picture(from)) return {};
  return pictures_.jpeg({});
}

std::uint64_t Hub::next_picture_number() const {
  const Snapshot* const newest = feed_.newest();
  return newest != nullptr ? newest->number : 0;
}

BugReportContent Hub::bug_report_content(std::uint64_t from, Instant now) {
  feed_.read();
  const auto text_in = [](const Outgoing& message) {
    return std::string(reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size());
  };
  BugReportContent content;
  content.scene = scene_;
  content.made = now;
  content.unix_time = unix_time_;
  content.hello =
      text_in(text_message([&](auto& json) { write_hello(json, scene_, setup_.is_running(), 0, unix_s(now)); }));
  content.status = text_in(status_message(now));
  content.events = links_.reports.events.all();
  content.snapshots = feed_.last(kBugReportTime);
  content.console = driving_.input();
  if (!has_picture(from)) return content;
  content.frame = *pictures_.frame();
  const std::size_t bytes = picture_layout(content.frame.format, content.frame.width_px, content.frame.height_px).bytes;
  // PictureExchange keeps the planes one after the other without padding.
  content.pixels.assign(content.frame.plane[0], content.frame.plane[0] + bytes);
  return content;
}

std::string Hub::metrics() {
  feed_.read();
  return metrics_text(feed_, report_, monitor_.status(), clients(), pictures_.compressed());
}

}  // namespace touchline::console
